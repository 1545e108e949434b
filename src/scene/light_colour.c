/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/light_colour.h"

#include "base/spectrum.h"
#include "scene/file_text.h"

#include <math.h>
#include <string.h>

/* A table of wavelengths in nm, rising, and relative powers. */
typedef struct table {
    size_t count;
    double (*row)[2];
} table;

static double look_up(const void *user, double nm)
{
    const table *t = user;
    if (t->count == 0 || nm < t->row[0][0] || nm > t->row[t->count - 1][0]) return 0;
    size_t i = 0;
    while (i + 2 < t->count && t->row[i + 1][0] <= nm) i++;
    if (i + 1 >= t->count) return t->row[i][1];
    double share = (nm - t->row[i][0]) / (t->row[i + 1][0] - t->row[i][0]);
    return t->row[i][1] + share * (t->row[i + 1][1] - t->row[i][1]);
}

/* Lines of two numbers; lines that begin with none (a heading, a comment) are passed over. */
static igi_status read_table(igi_context *ctx, const char *path, table *t)
{
    igi_text text = {NULL, 0};
    size_t capacity = 0;
    int line = 0;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_text_load(ctx, path, (size_t)1 << 20, &text));
    for (char *at = text.bytes, *end; *at; at = end) {
        const char *number = at;
        double row[2];
        line++;
        for (end = at; *end && *end != '\n';) end++;
        if (*end) *end++ = 0;
        if (!igi_scan_number(&number, &row[0])) continue;
        while (*number == ',' || *number == ';' || *number == ' ' || *number == '\t') number++;
        bool good = igi_scan_number(&number, &row[1]) && row[1] >= 0 && row[1] < 1e30;
        if (!good || !(row[0] > (t->count ? t->row[t->count - 1][0] : 0) && row[0] < 1e6))
            IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA,
                                  "%s:%d: no wavelength in nm above the last one with a power from "
                                  "0 behind it",
                                  path, line));
        double(*grown)[2] = igi_grow(ctx, t->row, &capacity, t->count + 1, sizeof *grown);
        if (!grown) {
            status = IGI_E_SYSTEM;
            goto cleanup;
        }
        t->row = grown;
        t->row[t->count][0] = row[0];
        t->row[t->count++][1] = row[1];
    }
    if (t->count < 2)
        status = igi_fail(ctx, IGI_E_DATA, "%s: no spectrum: lines of a wavelength and a power",
                          path);
cleanup:
    igi_free(text.bytes);
    return status;
}

static igi_status read_spectrum(igi_context *ctx, const igi_json *at, double rgb[3])
{
    const char *name;
    char *folder = NULL, *path = NULL;
    table t = {0, NULL};
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_json_string(ctx, at, &name));
    IGI_TRY_GOTO(igi_path_folder(ctx, at->file->path, &folder));
    IGI_TRY_GOTO(igi_path_join(ctx, folder, name, &path));
    IGI_TRY_GOTO(read_table(ctx, path, &t));
    igi_colour_of_spectrum(look_up, &t, rgb);
cleanup:
    igi_free(folder);
    igi_free(path);
    igi_free(t.row);
    return status;
}

/* Lines, each narrower than what an observer tells apart: [[nm, power], ...]. */
static igi_status read_lines(igi_context *ctx, const igi_json *at, double rgb[3])
{
    double xyz[3] = {0}, line[2], observer[3];
    size_t count;
    IGI_TRY(igi_json_array(ctx, at, &count));
    for (size_t i = 0; i < count; i++) {
        igi_json one = igi_json_element(at, i);
        IGI_TRY(igi_json_numbers(ctx, &one, 2, line));
        if (!(line[0] >= 360 && line[0] <= 830 && line[1] >= 0 && line[1] < 1e30))
            return igi_json_fail(ctx, &one, "is no line: give [NM from 360 to 830, POWER from 0]");
        igi_cie_1931(line[0], observer);
        for (int k = 0; k < 3; k++) xyz[k] += line[1] * observer[k];
    }
    if (!(xyz[1] > 0)) return igi_json_fail(ctx, at, "has no light that an eye sees; add a line");
    igi_colour_of_xyz(xyz, rgb);
    return IGI_OK;
}

static igi_status read_xy(igi_context *ctx, const igi_json *at, double rgb[3])
{
    double xy[2];
    IGI_TRY(igi_json_numbers(ctx, at, 2, xy));
    if (!(xy[0] >= 0 && xy[1] > 0 && xy[0] + xy[1] <= 1))
        return igi_json_fail(ctx, at,
                             "is no chromaticity of CIE 1931; give [x, y], white is "
                             "[0.3127, 0.3290]");
    const double xyz[3] = {xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]};
    igi_colour_of_xyz(xyz, rgb);
    return IGI_OK;
}

igi_status igi_json_hsv(igi_context *ctx, const igi_json *at, double rgb[3])
{
    double hsv[3];
    IGI_TRY(igi_json_numbers(ctx, at, 3, hsv));
    if (!(hsv[0] >= 0 && hsv[0] <= 360 && hsv[1] >= 0 && hsv[1] <= 1 && hsv[2] >= 0 && hsv[2] <= 1))
        return igi_json_fail(ctx, at,
                             "is no colour; give [hue from 0 to 360, saturation from 0 to "
                             "1, value from 0 to 1]");
    igi_rgb_of_hsv(hsv, rgb);
    return IGI_OK;
}

static igi_status read_temperature(igi_context *ctx, const igi_json *at, double rgb[3])
{
    double temperature;
    IGI_TRY(igi_json_number(ctx, at, &temperature));
    if (!(temperature >= 500 && temperature <= 1e5))
        return igi_json_fail(ctx, at, "is %g; give 500 to 100000 kelvin", temperature);
    igi_colour_of_temperature(temperature, rgb);
    return IGI_OK;
}

static igi_status read_hsv(igi_context *ctx, const igi_json *at, double rgb[3])
{
    IGI_TRY(igi_json_hsv(ctx, at, rgb));
    double luminance = igi_luminance(rgb);
    if (!(luminance > 0)) return igi_json_fail(ctx, at, "is black; give a value above 0");
    for (int k = 0; k < 3; k++) rgb[k] /= luminance;
    return IGI_OK;
}

igi_status igi_light_read_colour(igi_context *ctx, const igi_json *at, int bands, double *colour,
                                 igi_json *stated)
{
    static const char *const keys[] = {IGI_LIGHT_COLOUR_KEYS};
    igi_status (*const readers[])(igi_context *, const igi_json *, double[3]) = {
        read_temperature, read_spectrum, read_lines, read_xy, read_hsv};
    size_t which = 0;
    *stated = (igi_json){0};
    for (int b = 0; b < bands; b++) colour[b] = 1;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        igi_json member = igi_json_member(at, keys[i]);
        if (!member.value) continue;
        if (stated->value)
            return igi_json_fail(ctx, &member, "stands beside \"%s\"; keep one of them",
                                 keys[which]);
        *stated = member;
        which = i;
    }
    if (!stated->value) return IGI_OK;
    if (bands != 3)
        return igi_json_fail(ctx, stated, "is for images of 3 bands (RGB), these have %d", bands);
    return readers[which](ctx, stated, colour);
}
