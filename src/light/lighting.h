/* SPDX-License-Identifier: Apache-2.0
 *
 * The prepared lights' fields, for src/light alone.
 */
#ifndef IGI_SRC_LIGHT_LIGHTING_H
#define IGI_SRC_LIGHT_LIGHTING_H

#include "light/light.h"
#include "light/sky.h"
#include "scene/light_profile.h"

#include <igi/image.h>

/* A triangle of an area light. */
typedef struct emitter {
    igi_vec corner, edge1, edge2, normal, centre;
    float area;
} emitter;

typedef struct source {
    const igi_light *light;
    size_t first, count;    /* area: its emitters */
    float area;             /* area: of all its emitters */
    igi_vec middle;         /* area: of a ball that holds them, */
    float radius;           /* and its radius */
    igi_vec position, axis; /* axis: direction of spot and directional; line: from end to end */
    float length;           /* line */
    float cos_cutoff, cutoff, beam; /* spot; angles in radians */
    sky *sky;                       /* env */
    profile *profile;               /* goniometric */
} source;

struct igi_lighting {
    const igi_scene *scene;
    int bands;
    size_t count;
    source *sources;
    size_t emitter_count; /* there is room for; */
    emitter *emitters;
    float *pieces;        /* [IGI_PIECE_VALUES][emitter_count] centres, normals and areas again */
    float *areas;         /* of the emitters of the same light up to and including each */
    uint32_t *cuts;       /* of its n emitters, the first whose areas exceed k/n of all, k < n */
    int *light_of_region; /* -1: dark */
};

/* From here on the closed form of each triangle of a light costs more than it gives. */
#define MANY_EMITTERS 1024

#define IGI_PIECE_VALUES 7
/* Fills `pieces`. */
void igi_emitters_arrange(igi_lighting *lighting);
/* Solid angle of the front of each emitter from `first` on, were it far away. */
void igi_emitters_angles(const igi_lighting *lighting, size_t first, size_t count, igi_vec point,
                         float *angles);
/* Irradiance by each of the light's emitters, were nothing in between, for a radiance of 1; returns
 * the sum. */
float igi_emitters_weigh(const igi_lighting *lighting, const source *s, igi_vec point,
                         igi_vec normal, float *weights);

/* By which the bands of an environment count in its irradiance: share[bands], as they shine; alike,
 * when none does. */
void igi_band_shares(const igi_lighting *lighting, size_t light, float *share);

#endif
