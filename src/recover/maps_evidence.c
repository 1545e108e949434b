/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/maps_private.h"

bool igi_is_textured(const igi_problem *problem, const igi_field *field,
                     const igi_region_sides *sides, uint32_t region)
{
    (void)problem;
    (void)field;
    (void)sides;
    (void)region;
    return false;
}
