/* SPDX-License-Identifier: Apache-2.0
 *
 * Materials come from a table of measured ones (lines of NAME and rho_d, rho_s for R, G, B and Ward's
 * alpha), or level by level from ranges.
 */
#include "synth/random_ranges.h"

#include "scene/file_text.h"

#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TABLE_BYTES (1 << 20)

static igi_status read_range(igi_context *ctx, const igi_json *object, const char *key,
                             const double limits[2], double range[2])
{
    igi_json at = igi_json_member(object, key);
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_numbers(ctx, &at, 2, range));
    if (range[0] >= limits[0] && range[1] <= limits[1] && range[0] <= range[1]) return IGI_OK;
    return igi_json_fail(ctx, &at, "is from %g to %g; give a range within %g to %g", range[0],
                         range[1], limits[0], limits[1]);
}

static igi_status read_room(igi_context *ctx, const igi_json *at, random_ranges *r)
{
    static const char *const known[] = {"low", "high"};
    igi_json room = igi_json_member(at, "room");
    if (!room.value) return IGI_OK;
    IGI_TRY(igi_json_object(ctx, &room));
    IGI_TRY(igi_json_check_keys(ctx, &room, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, &room, "low", r->low));
    IGI_TRY(member_vector(ctx, &room, "high", r->high));
    for (int k = 0; k < 3; k++)
        if (!(r->low[k] >= 2 && r->low[k] <= r->high[k] && r->high[k] <= 100))
            return igi_json_fail(ctx, &room, "needs sides from 2 to 100 metres, low before high");
    return IGI_OK;
}

static igi_status read_ranges(igi_context *ctx, const igi_json *at, random_ranges *r)
{
    static const char *const known[] = {"room",   "furniture", "lamps",  "lamp_size",
                                        "glossy", "textured",  "albedo", "specular",
                                        "alpha",  "radiance",  "table"};
    const double count[2] = {0, RANDOM_MOST}, one[2] = {1, RANDOM_MOST}, metres[2] = {0.05, 1},
                 bright[2] = {0.1, 1e4};
    const double share[2] = {1e-3, 0.95}, lobe[2] = {1e-4, 0.5}, width[2] = {1e-3, 1};
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(read_room(ctx, at, r));
    IGI_TRY(read_range(ctx, at, "furniture", count, r->furniture));
    IGI_TRY(read_range(ctx, at, "lamps", one, r->lamps));
    IGI_TRY(read_range(ctx, at, "lamp_size", metres, r->lamp_size));
    IGI_TRY(read_range(ctx, at, "radiance", bright, r->radiance));
    IGI_TRY(read_range(ctx, at, "albedo", share, r->albedo));
    IGI_TRY(read_range(ctx, at, "specular", lobe, r->specular));
    IGI_TRY(read_range(ctx, at, "alpha", width, r->alpha));
    IGI_TRY(optional_number(ctx, at, "glossy", 0, 1, &r->glossy));
    return optional_number(ctx, at, "textured", 0, 1, &r->textured);
}

/* One line of the table; what would send out more light than it receives is passed over. */
static igi_status read_row(igi_context *ctx, random_ranges *r, const char *line, const char *path,
                           size_t number)
{
    const char *at = strchr(line, ',');
    double *row = r->table[r->rows];
    for (int k = 0; k < 7; k++) {
        if (at && *at == ',') at++;
        if (!at || !igi_scan_number(&at, &row[k]) || !(row[k] >= 0 && row[k] < 10))
            return igi_fail(ctx, IGI_E_DATA,
                            "%s:%zu: no material; a line has a name, rho_d and rho_s for R, G, B "
                            "and alpha, with commas between",
                            path, number);
    }
    bool possible = row[6] >= 1e-3 && row[6] <= 1;
    for (int b = 0; b < 3; b++) possible = possible && row[b] + row[3 + b] <= 1;
    r->rows += possible;
    return IGI_OK;
}

static igi_status read_table(igi_context *ctx, random_ranges *r, const char *path)
{
    igi_text text;
    IGI_TRY(igi_text_load(ctx, path, TABLE_BYTES, &text));
    size_t lines = 1, number = 1;
    for (size_t i = 0; i < text.size; i++) lines += text.bytes[i] == '\n';
    igi_status status = IGI_ALLOC(ctx, lines, &r->table);
    for (const char *at = text.bytes; status == IGI_OK; number++) {
        if (number > 1 && *at)
            status = read_row(ctx, r, at, path, number); /* the first is a heading */
        at = strchr(at, '\n');
        if (!at++) break;
    }
    if (status == IGI_OK && r->rows == 0)
        status = igi_fail(ctx, IGI_E_DATA, "%s: has no possible material; give a table", path);
    igi_free(text.bytes);
    return status;
}

/* The table lies beside the spec, or where its absolute path says. */
static igi_status find_table(igi_context *ctx, random_ranges *r, const igi_json *at)
{
    igi_json table = igi_json_member(at, "table");
    const char *name;
    char *folder = NULL, *path = NULL;
    if (!table.value) return IGI_OK;
    IGI_TRY(igi_json_string(ctx, &table, &name));
    igi_status status = igi_path_folder(ctx, at->file->path, &folder);
    if (status == IGI_OK) status = igi_path_join(ctx, folder, name, &path);
    if (status == IGI_OK) status = read_table(ctx, r, path);
    igi_free(folder);
    igi_free(path);
    return status;
}

igi_status random_ranges_read(igi_context *ctx, const igi_json *at, random_ranges *ranges)
{
    *ranges = (random_ranges){.low = {3, 3, 2.4},
                              .high = {5, 5, 3.2},
                              .furniture = {3, 6},
                              .lamps = {1, 3},
                              .lamp_size = {0.3, 0.8},
                              .radiance = {8, 30},
                              .glossy = 0.6,
                              .textured = 0.2,
                              .albedo = {0.02, 0.9},
                              .specular = {0.005, 0.2},
                              .alpha = {0.006, 0.5}};
    IGI_TRY(read_ranges(ctx, at, ranges));
    return find_table(ctx, ranges, at);
}
