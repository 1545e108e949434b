/* SPDX-License-Identifier: Apache-2.0
 *
 * EULUMDAT (A. Stockmar, 1990): a number or a name on each line, at fixed places. Of the Mc planes
 * C that a symmetry leaves, intensities in candela per 1000 lm of the lamps, C slowest. 0 degrees is
 * straight down, as in LM-63.
 */
#include "light/profile.h"

#include "scene/file_text.h"

#include <math.h>
#include <string.h>

#define HEAD_LINES 26
#define MOST_LAMPS 20

typedef struct head {
    int symmetry, planes, angles, first, stored; /* first, stored: planes with intensities */
    double factor;                               /* candela for one in the file */
} head;

static igi_status wrong(igi_context *ctx, const char *path, int line, const char *what)
{
    return igi_fail(ctx, IGI_E_DATA, "%s:%d: no usable EULUMDAT profile: %s", path, line, what);
}

/* The start of the next line; NULL at the end. */
static const char *next_line(const char *at)
{
    at = strchr(at, '\n');
    return at ? at + 1 : NULL;
}

/* The number on each of `count` lines, where there is one. */
static const char *read_lines(const char *at, int count, double *values)
{
    for (int i = 0; i < count; i++) {
        const char *number = at;
        if (!at) return NULL;
        values[i] = (double)NAN;
        while (*number == ' ' || *number == '\t') number++;
        if (!igi_scan_number(&number, &values[i])) values[i] = (double)NAN;
        at = next_line(at);
    }
    return at;
}

static bool is_count(double x, double low, double high)
{
    return x >= low && x <= high && x == floor(x);
}

/* Lines are numbered from 1, values from 0. */
static igi_status read_head(igi_context *ctx, const char *path, const char **at, head *h)
{
    double line[HEAD_LINES], lamp[6], lumens = 0;
    const char *next = read_lines(*at, HEAD_LINES, line);
    if (!next) return wrong(ctx, path, HEAD_LINES, "its head is cut short");
    if (!is_count(line[2], 0, 4)) return wrong(ctx, path, 3, "its symmetry is none of 0 to 4");
    if (!is_count(line[3], 1, 721) || (int)line[3] % 4)
        if (line[2] > 1 || !is_count(line[3], 1, 721))
            return wrong(ctx, path, 4, "the number of planes is out of range for its symmetry");
    if (!is_count(line[5], 2, PROFILE_MOST_ANGLES))
        return wrong(ctx, path, 6, "the number of angles is out of range");
    if (!(line[23] > 0 && line[23] < 1e6)) return wrong(ctx, path, 24, "no conversion factor");
    if (!is_count(line[25], 1, MOST_LAMPS)) return wrong(ctx, path, 26, "no set of lamps");
    for (int i = 0; i < (int)line[25]; i++) {
        next = next ? read_lines(next, 6, lamp) : NULL;
        if (next && i == 0) lumens = lamp[2];
    }
    if (!(lumens > 0 && lumens < 1e12)) return wrong(ctx, path, 29, "no lamp flux above zero");
    h->symmetry = (int)line[2];
    h->planes = (int)line[3];
    h->angles = (int)line[5];
    int quarter = h->planes / 4;
    h->first = h->symmetry == 3 ? 3 * quarter : 0;
    h->stored = h->symmetry == 0   ? h->planes
                : h->symmetry == 1 ? 1
                : h->symmetry == 4 ? quarter + 1
                                   : 2 * quarter + 1;
    h->factor = line[23] * lumens / 1000;
    double ratios[10];
    *at = next ? read_lines(next, 10, ratios) : NULL;
    return *at ? IGI_OK : wrong(ctx, path, HEAD_LINES, "it ends before the angles");
}

static igi_status read_body(igi_context *ctx, const char *path, const char *at, const head *h,
                            double *values, profile *p)
{
    size_t angles = (size_t)h->angles, planes = (size_t)h->planes;
    size_t count = planes + angles + (size_t)h->stored * angles;
    for (size_t i = 0; i < count; i++)
        if (!profile_number(&at, &values[i]))
            return wrong(ctx, path, HEAD_LINES, "it ends among the angles or intensities");
    for (size_t i = 0; i < angles; i++) p->vertical[i] = (float)values[planes + i];
    for (int k = 0; k < p->horizontals; k++) {
        /* Symmetry 3 stores 270 to 90 degrees; kept is the other half, 90 to 270, its mirror. */
        int from = h->symmetry == 3 ? h->stored - 1 - k : k % h->planes;
        int plane = (h->first + from) % h->planes;
        double angle = values[plane];
        if (h->symmetry == 3) angle = angle > 180 ? 540 - angle : 180 - angle;
        if (h->symmetry == 0 && k == h->planes) angle += 360; /* the circle is closed */
        p->horizontal[k] = (float)angle;
        for (size_t i = 0; i < angles; i++) {
            double x = values[planes + angles + (size_t)from * angles + i] * h->factor;
            if (!(x >= 0 && x < 1e30))
                return wrong(ctx, path, HEAD_LINES, "an intensity below zero");
            p->candela[(size_t)k * angles + i] = (float)x;
        }
    }
    for (int i = 1; i < p->verticals; i++)
        if (!(p->vertical[i] > p->vertical[i - 1]))
            return wrong(ctx, path, HEAD_LINES, "its angles G do not rise");
    for (int i = 1; i < p->horizontals; i++)
        if (!(p->horizontal[i] > p->horizontal[i - 1]))
            return wrong(ctx, path, HEAD_LINES, "its planes C do not rise");
    return IGI_OK;
}

igi_status profile_read_ldt(igi_context *ctx, const char *path, const char *text, profile *p)
{
    head h = {0};
    double *values;
    const char *at = text;
    IGI_TRY(read_head(ctx, path, &at, &h));
    p->verticals = h.angles;
    p->horizontals = h.symmetry == 0 && h.planes > 1 ? h.stored + 1 : h.stored;
    IGI_TRY(profile_allocate(ctx, p));
    size_t angles = (size_t)h.angles;
    IGI_TRY(IGI_ALLOC(ctx, (size_t)h.planes + angles + (size_t)h.stored * angles, &values));
    igi_status status = read_body(ctx, path, at, &h, values, p);
    igi_free(values);
    return status;
}
