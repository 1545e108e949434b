/* SPDX-License-Identifier: Apache-2.0
 *
 * ANSI/IES LM-63 (1986 to 2019): after the line TILT=, ten numbers and three, then the vertical
 * angles, the horizontal angles, and the candela values, vertical fastest.
 */
#include "light/profile.h"

#include <string.h>

static igi_status wrong(igi_context *ctx, const char *path, const char *what)
{
    return igi_fail(ctx, IGI_E_DATA, "%s: no usable IES LM-63 profile: %s", path, what);
}

/* Behind the TILT line; a tilt table changes with how the lamp hangs, which nothing here says. */
static igi_status skip_head(igi_context *ctx, const char *path, const char **at)
{
    const char *tilt = strstr(*at, "TILT=");
    if (!tilt) return wrong(ctx, path, "it has no TILT= line");
    if (strncmp(tilt, "TILT=NONE", 9) != 0) return wrong(ctx, path, "only TILT=NONE is read");
    *at = tilt + 9;
    return IGI_OK;
}

static igi_status read_angles(igi_context *ctx, const char *path, const char **at, int count,
                              float *angles)
{
    for (int i = 0; i < count; i++) {
        double x;
        if (!profile_number(at, &x)) return wrong(ctx, path, "it ends among the angles");
        angles[i] = (float)x;
        if (i && !(angles[i] > angles[i - 1])) return wrong(ctx, path, "its angles do not rise");
    }
    return IGI_OK;
}

igi_status profile_read_ies(igi_context *ctx, const char *path, const char *at, profile *p)
{
    double head[13], x;
    IGI_TRY(skip_head(ctx, path, &at));
    for (int i = 0; i < 13; i++)
        if (!profile_number(&at, &head[i])) return wrong(ctx, path, "its head is cut short");
    if (!(head[3] >= 2 && head[3] <= PROFILE_MOST_ANGLES && head[4] >= 1 &&
          head[4] <= PROFILE_MOST_ANGLES))
        return wrong(ctx, path, "the numbers of angles are out of range");
    if (head[5] != 1) return wrong(ctx, path, "its photometry is not of type C");
    double factor = head[2] * head[10] * head[11]; /* multiplier, ballast, ballast-lamp */
    p->verticals = (int)head[3];
    p->horizontals = (int)head[4];
    size_t count = (size_t)p->verticals * (size_t)p->horizontals;
    IGI_TRY(profile_allocate(ctx, p));
    IGI_TRY(read_angles(ctx, path, &at, p->verticals, p->vertical));
    IGI_TRY(read_angles(ctx, path, &at, p->horizontals, p->horizontal));
    for (size_t i = 0; i < count; i++) {
        if (!profile_number(&at, &x)) return wrong(ctx, path, "it ends among the candela values");
        p->candela[i] = (float)(x * factor);
        if (!(p->candela[i] >= 0)) return wrong(ctx, path, "a candela value is below zero");
    }
    return IGI_OK;
}
