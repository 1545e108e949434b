/* SPDX-License-Identifier: Apache-2.0
 *
 * Wavefront OBJ, as far as it concerns triangles: v, vt, f and usemtl. Normals, smoothing, groups,
 * material libraries, lines, points and free-form surfaces are passed over.
 */
#include "scene/mesh_builder.h"
#include "scene/polygon.h"

#include <string.h>

typedef struct obj_reader {
    igi_mesh_builder *mesh;
    igi_context *ctx;
    const char *file, *at, *end;
    uint32_t line;
    uint32_t region;
    bool has_region;
    uint32_t large_line; /* of the first polygon too large to be looked at, or 0 */
} obj_reader;

static igi_status fail(const obj_reader *r, const char *what)
{
    return igi_fail(r->ctx, IGI_E_DATA, "%s:%u: %s", r->file, (unsigned)r->line, what);
}

/* Blanks within a line; a backslash before the line's end joins the next line to it. */
static void skip_blanks(obj_reader *r)
{
    for (;;) {
        const char *p = r->at;
        while (*p == ' ' || *p == '\t' || *p == '\r') p++;
        r->at = p;
        if (*p != '\\') return;
        p++;
        if (*p == '\r') p++;
        if (*p != '\n') return;
        r->at = p + 1;
        r->line++;
    }
}

static void skip_line(obj_reader *r)
{
    const char *newline = r->at;
    const bool comment = *newline == '#'; /* one may end with the backslash of a folder's name */
    do {                                  /* a continued line is one line */
        newline = memchr(newline, '\n', (size_t)(r->end - newline));
        if (!newline) {
            r->at = r->end;
            return;
        }
        r->line++;
        newline++;
    } while (!comment && ((newline - r->at >= 2 && newline[-2] == '\\') ||
                          (newline - r->at >= 3 && newline[-2] == '\r' && newline[-3] == '\\')));
    r->at = newline;
}

static bool at_line_end(const obj_reader *r)
{
    return *r->at == '\n' || *r->at == '#' || r->at >= r->end;
}

/* Reads up to `count` numbers and says how many there were. */
static int read_numbers(obj_reader *r, double *values, int count)
{
    int got = 0;
    for (; got < count; got++) {
        skip_blanks(r);
        if (!igi_scan_number(&r->at, &values[got])) break;
    }
    return got;
}

static igi_status read_vertex(obj_reader *r)
{
    double p[3];
    uint32_t line = r->line;
    if (read_numbers(r, p, 3) != 3) return fail(r, "\"v\" without three numbers; mend the line");
    return igi_mesh_builder_vertex(r->mesh, p, line);
}

static igi_status read_uv(obj_reader *r)
{
    double uv[2] = {0, 0};
    uint32_t line = r->line;
    if (read_numbers(r, uv, 2) < 1) return fail(r, "\"vt\" without a number; mend the line");
    return igi_mesh_builder_uv(r->mesh, uv, line);
}

/* An index counts from 1, or back from the last one so far if negative. */
static bool read_index(obj_reader *r, size_t count, uint32_t *index)
{
    const char *p = r->at;
    bool negative = *p == '-';
    p += negative;
    if (*p < '0' || *p > '9') return false;
    uint64_t n = 0;
    for (; *p >= '0' && *p <= '9'; p++)
        if (n <= UINT32_MAX) n = n * 10 + (uint64_t)(*p - '0');
    r->at = p;
    if (n == 0 || n >= UINT32_MAX || (negative && n > count)) return false;
    *index = (uint32_t)(negative ? count - n : n - 1);
    return true;
}

/* v, v/vt, v//vn or v/vt/vn */
static igi_status read_corner(obj_reader *r, uint32_t *vertex, uint32_t *uv)
{
    *uv = IGI_NO_UV;
    if (!read_index(r, r->mesh->vertex_count, vertex))
        return fail(r,
                    "a face names a vertex that cannot be; indices count from 1, or from -1 back");
    if (*r->at != '/') return IGI_OK;
    r->at++;
    if (*r->at != '/' && !read_index(r, r->mesh->uv_count, uv))
        return fail(r, "a face names a texture coordinate that cannot be; indices count from 1, or "
                       "from -1 back");
    if (*r->at != '/') return IGI_OK;
    r->at++;
    while (*r->at == '-' || (*r->at >= '0' && *r->at <= '9')) r->at++; /* the normal */
    return IGI_OK;
}

/* The fan of the last face is not it when the polygon is not convex. */
static void mend_fan(obj_reader *r, const igi_face *corners, size_t count)
{
    double points[IGI_POLYGON_MAX][3];
    uint32_t triangles[IGI_POLYGON_MAX][3];
    for (size_t i = 0; i < count; i++) {
        if (corners[i].vertex[0] >= r->mesh->vertex_count) return; /* it stands further down */
        for (int k = 0; k < 3; k++)
            points[i][k] = (double)r->mesh->positions[3 * (size_t)corners[i].vertex[0] + (size_t)k];
    }
    if (igi_polygon_split((const double(*)[3])points, count, triangles)) return;
    igi_face *faces = r->mesh->faces + r->mesh->face_count - (count - 2);
    for (size_t i = 0; i + 2 < count; i++)
        for (int k = 0; k < 3; k++) {
            faces[i].vertex[k] = corners[triangles[i][k]].vertex[0];
            faces[i].uv[k] = corners[triangles[i][k]].uv[0];
        }
}

/* Polygons become fans around their first corner, or what mend_fan makes of them. */
static igi_status read_face(obj_reader *r)
{
    igi_face face = {.line = r->line}, corners[IGI_POLYGON_MAX];
    size_t count = 0;
    if (!r->has_region) {
        IGI_TRY(igi_mesh_builder_region(r->mesh, "default", 7, r->line, &r->region));
        r->has_region = true;
    }
    face.region = r->region;
    for (skip_blanks(r); !at_line_end(r); skip_blanks(r), count++) {
        uint32_t vertex = 0, uv;
        IGI_TRY(read_corner(r, &vertex, &uv));
        size_t k = count < 2 ? count : 2;
        if (count > 2) {
            face.vertex[1] = face.vertex[2];
            face.uv[1] = face.uv[2];
        }
        face.vertex[k] = vertex;
        face.uv[k] = uv;
        if (k == 2) IGI_TRY(igi_mesh_builder_face(r->mesh, &face));
        if (count >= IGI_POLYGON_MAX) continue;
        corners[count].vertex[0] = vertex;
        corners[count].uv[0] = uv;
    }
    if (count < 3) return fail(r, "a face of less than three corners; remove the line");
    if (count > IGI_POLYGON_MAX && !r->large_line) r->large_line = face.line;
    if (count > 3 && count <= IGI_POLYGON_MAX) mend_fan(r, corners, count);
    return IGI_OK;
}

static igi_status read_material(obj_reader *r)
{
    skip_blanks(r);
    const char *name = r->at, *stop = name;
    while (stop < r->end && *stop != '\n') stop++;
    while (stop > name && (stop[-1] == ' ' || stop[-1] == '\t' || stop[-1] == '\r')) stop--;
    if (stop == name) { /* as some exporters write where there is no material */
        name = "default";
        stop = name + strlen(name);
    } else {
        r->at = stop;
    }
    r->has_region = true;
    return igi_mesh_builder_region(r->mesh, name, (size_t)(stop - name), r->line, &r->region);
}

static bool starts(const obj_reader *r, const char *word, size_t length)
{
    return strncmp(r->at, word, length) == 0 && strchr(" \t\r\n\\", r->at[length]);
}

static igi_status read_statement(obj_reader *r)
{
    skip_blanks(r);
    if (starts(r, "v", 1)) {
        r->at++;
        return read_vertex(r);
    }
    if (starts(r, "vt", 2)) {
        r->at += 2;
        return read_uv(r);
    }
    if (starts(r, "f", 1)) {
        r->at++;
        return read_face(r);
    }
    if (starts(r, "usemtl", 6)) {
        r->at += 6;
        return read_material(r);
    }
    return IGI_OK;
}

igi_status igi_obj_read(igi_mesh_builder *builder, const igi_text *text)
{
    obj_reader r = {.mesh = builder, .ctx = builder->ctx, .file = builder->file};
    r.at = text->bytes;
    r.end = text->bytes + text->size;
    for (r.line = 1; r.at < r.end; skip_line(&r)) IGI_TRY(read_statement(&r));
    if (r.large_line)
        igi_warn(r.ctx,
                 "%s:%u: a polygon of more than %d corners, split as if it were convex; if it is "
                 "not, triangulate it",
                 r.file, (unsigned)r.large_line, IGI_POLYGON_MAX);
    return IGI_OK;
}
