/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp's intensities by direction: the table that readers fill, and its values.
 */
#include "light/profile.h"

#include "scene/file_text.h"

#include <math.h>

bool profile_number(const char **at, double *value)
{
    while (**at == ',' || **at == ' ' || **at == '\t' || **at == '\r' || **at == '\n') ++*at;
    return igi_scan_number(at, value) && isfinite(*value);
}

igi_status profile_allocate(igi_context *ctx, profile *p)
{
    IGI_TRY(IGI_ALLOC(ctx, (size_t)p->verticals, &p->vertical));
    IGI_TRY(IGI_ALLOC(ctx, (size_t)p->horizontals, &p->horizontal));
    return IGI_ALLOC(ctx, (size_t)p->verticals * (size_t)p->horizontals, &p->candela);
}

void profile_destroy(profile *p)
{
    if (!p) return;
    igi_free(p->vertical);
    igi_free(p->horizontal);
    igi_free(p->candela);
    igi_free(p);
}

/* The step that holds x, and how far in it; false beyond the ends. */
static bool bracket(const float *angles, int count, float x, int *step, float *within)
{
    *step = 0;
    *within = 0;
    if (count == 1) return true;
    if (x < angles[0] - 1e-3f || x > angles[count - 1] + 1e-3f) return false;
    while (*step + 2 < count && angles[*step + 1] <= x) ++*step;
    *within = (x - angles[*step]) / (angles[*step + 1] - angles[*step]);
    *within = fminf(1.0f, fmaxf(0.0f, *within));
    return true;
}

/* Horizontal angles up to 90 stand for four quadrants, up to 180 for two halves; from 90 to 270
 * for the two halves beside the other plane. */
static float fold(const profile *p, float angle)
{
    float low = p->horizontal[0], high = p->horizontal[p->horizontals - 1];
    if (angle < 0) angle += 360;
    if (low >= 89 && high <= 271)
        return angle < 90 ? 180 - angle : angle > 270 ? 540 - angle : angle;
    if (high > 181) return angle;
    if (angle > 180) angle = 360 - angle;
    return high <= 91 && angle > 90 ? 180 - angle : angle;
}

float profile_intensity(const profile *p, igi_vec d)
{
    int i, j;
    float a, b, down = acosf(fminf(1.0f, fmaxf(-1.0f, -d.z))) * 180 / IGI_PIF;
    float around = fold(p, atan2f(d.y, d.x) * 180 / IGI_PIF);
    if (!bracket(p->vertical, p->verticals, down, &i, &a)) return 0;
    if (!bracket(p->horizontal, p->horizontals, around, &j, &b)) return 0;
    const float *row = p->candela + (size_t)j * (size_t)p->verticals + i;
    const float *next = p->horizontals > 1 ? row + p->verticals : row;
    return (1 - b) * ((1 - a) * row[0] + a * row[1]) + b * ((1 - a) * next[0] + a * next[1]);
}
