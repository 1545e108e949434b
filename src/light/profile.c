/* SPDX-License-Identifier: Apache-2.0
 *
 * ANSI/IES LM-63 (1986 to 2019): after the line TILT=, ten numbers and three, then the vertical
 * angles, the horizontal angles, and the candela values, vertical fastest.
 */
#include "light/profile.h"

#include "scene/file_text.h"

#include <math.h>
#include <string.h>

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

static igi_status read_body(igi_context *ctx, const char *path, const char *at, profile *p)
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

igi_status profile_load(igi_context *ctx, const char *path, profile **result)
{
    igi_text text = {NULL, 0};
    igi_status status = IGI_OK;
    *result = NULL;
    IGI_TRY_GOTO(igi_text_load(ctx, path, (size_t)16 << 20, &text));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, result));
    IGI_TRY_GOTO(igi_ends_with(path, ".ldt") ? profile_read_ldt(ctx, path, text.bytes, *result)
                                             : read_body(ctx, path, text.bytes, *result));
cleanup:
    igi_free(text.bytes);
    if (status != IGI_OK) {
        profile_destroy(*result);
        *result = NULL;
    }
    return status;
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
