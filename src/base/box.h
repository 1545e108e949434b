/* SPDX-License-Identifier: Apache-2.0
 *
 * A box along the axes, grown point by point.
 */
#ifndef IGI_SRC_BASE_BOX_H
#define IGI_SRC_BASE_BOX_H

#include "base/vec.h"

typedef struct igi_box {
    igi_vec low, high; /* low above high: it holds no point */
} igi_box;

static inline igi_box igi_box_empty(void)
{
    igi_vec far = igi_v(INFINITY, INFINITY, INFINITY);
    return (igi_box){far, igi_scale(far, -1)};
}
static inline void igi_box_add(igi_box *box, igi_vec p)
{
    igi_vec low = box->low, high = box->high;
    box->low = igi_v(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
    box->high = igi_v(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
}
/* Its lengths along x, y and z. */
static inline igi_vec igi_box_sides(const igi_box *box)
{
    return igi_sub(box->high, box->low);
}
/* From corner to corner. */
static inline float igi_box_diagonal(const igi_box *box)
{
    return igi_length(igi_box_sides(box));
}

#endif
