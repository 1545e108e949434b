/* SPDX-License-Identifier: Apache-2.0
 *
 * A lobe's value for many pairs of directions and many roughnesses, quickly.
 *
 * An isotropic lobe depends on a pair by three numbers alone: both cosines with the normal, and the
 * length of in + out within the surface, which is 0 toward the mirror direction. What of its value
 * does not depend on roughness is found once; the rest is arithmetic on plain arrays, which compilers
 * turn into vectors. Values agree with igi_lobe_terms to float's accuracy.
 */
#ifndef IGI_SRC_BRDF_LOBE_PAIRS_H
#define IGI_SRC_BRDF_LOBE_PAIRS_H

#include "base/context.h"
#include "brdf/brdf.h"

#define IGI_LOBE_LANES 8 /* pairs are looked at by so many */

typedef struct igi_lobe_pairs {
    igi_model model;
    size_t count, room;           /* room: a multiple of IGI_LOBE_LANES */
    float *across, *in_z, *out_z; /* [room] |in + out|^2 within the surface; cosines, > 0 */
    float *factor, *decay;        /* [room] what igi_lobe_pairs_prepare finds */
    float *schlick; /* [room] (1 - cos)^5 of ggx, which parts scale and base; else 0 */
    float *nearest; /* [room / IGI_LOBE_LANES] the least decay */
    float *values;  /* [room] of the last evaluation */
} igi_lobe_pairs;

IGI_MUST_USE igi_status igi_lobe_pairs_create(igi_context *ctx, igi_model model, size_t room,
                                              igi_lobe_pairs *pairs);
void igi_lobe_pairs_clear(igi_lobe_pairs *pairs);

/* Both above the surface, unit vectors in its frame. */
static inline void igi_lobe_pairs_add(igi_lobe_pairs *p, igi_vec in, igi_vec out)
{
    float x = in.x + out.x, y = in.y + out.y;
    p->across[p->count] = x * x + y * y;
    p->in_z[p->count] = in.z;
    p->out_z[p->count++] = out.z;
}

/* Fills up with pairs far from any lobe, to a multiple of IGI_LOBE_LANES. */
void igi_lobe_pairs_pad(igi_lobe_pairs *pairs);
void igi_lobe_pairs_prepare(igi_lobe_pairs *pairs);

/* values[first..last): f_s for rho_s = 1 and no base; ggx: times (1 - schlick) for the scale, times
 * schlick for the base. first and last are multiples of IGI_LOBE_LANES. */
void igi_lobe_pairs_evaluate(igi_lobe_pairs *pairs, float alpha, size_t first, size_t last);

#endif
