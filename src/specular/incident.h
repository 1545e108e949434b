/* SPDX-License-Identifier: Apache-2.0
 *
 * Radiance that arrives along a ray, with the present estimate of the materials.
 *
 * A glossy surface sends different light to a point than a camera saw from it. What leaves y toward
 * x is its diffuse part, the same in all directions, plus its lobe toward x, estimated by one
 * sample of each lamp and one of the lobe (the 1999 paper's Delta S, with one bounce). What a lobe
 * mirrors is taken so too: lobes seen in lobes are .5 % of the albedo of a glossy block among glossy
 * walls. Beyond that, what cameras saw on average stands for what leaves.
 */
#ifndef IGI_SRC_SPECULAR_INCIDENT_H
#define IGI_SRC_SPECULAR_INCIDENT_H

#include "diffuse/problem.h"

/* The specular lobe of a region: IGI_LAMBERT where there is none. */
typedef struct igi_lobe {
    igi_model model;
    float alpha;
    float specular[IGI_MAX_BANDS]; /* rho_s per band; all alike but for coloured lobes */
} igi_lobe;

/* A sharper lobe meets none or one of some points on a lamp: rays of the lobe look for lamps. */
#define IGI_SHARP_ALPHA 0.04f

typedef struct igi_radiance_field {
    const igi_problem *problem;
    const float *diffuse;  /* [2 patches][bands] the part of each side that all directions share */
    const float *total;    /* [2 patches][bands] with the lobe as the cameras saw it on average */
    const igi_lobe *lobes; /* [regions], or NULL: every side sends `total` in all directions */
} igi_radiance_field;

/* Adds what leaves `hit`, reached from `origin` along `direction`, back along the ray. Lamps add
 * nothing. Returns the number of rays it cost. */
int igi_radiance_toward(const igi_radiance_field *field, igi_vec origin, igi_vec direction,
                        const igi_hit *hit, igi_rng *rng, float *radiance);

/* One estimate of the lobe's radiance at `point` toward the unit vector `out`, per band, added to
 * `lamps` and to `surfaces` by where the light came from (they may be the same; lamps NULL: only what
 * surfaces send, as cameras saw them, and what light no sample finds). Returns the rays it cost. */
int igi_lobe_radiance(const igi_radiance_field *field, const igi_lobe *lobe, igi_vec point,
                      igi_vec normal, igi_vec out, igi_rng *rng, float *lamps, float *surfaces);

/* Coordinates of a direction in the frame whose z is the normal. */
static inline igi_vec igi_to_local(igi_vec d, igi_vec normal)
{
    igi_vec t, b;
    igi_frame_of(normal, &t, &b);
    return igi_v(igi_dot(d, t), igi_dot(d, b), igi_dot(d, normal));
}

static inline igi_vec igi_to_world(igi_vec d, igi_vec normal)
{
    igi_vec t, b;
    igi_frame_of(normal, &t, &b);
    return igi_madd(igi_madd(igi_scale(normal, d.z), t, d.x), b, d.y);
}

#endif
