/* SPDX-License-Identifier: Apache-2.0
 *
 * Shapes into faces, and faces into a Wavefront OBJ. Texture coordinates are written where the
 * material has a texture: elsewhere faces would share them without a reason.
 */
#include "synth/synth.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define PI 3.14159265358979323846

static igi_status find_material(igi_context *ctx, const spec *s, const igi_json *at, int *material)
{
    const char *name;
    IGI_TRY(igi_json_string(ctx, at, &name));
    for (size_t i = 0; i < s->materials->count; i++)
        if (strcmp(s->materials->materials[i].region, name) == 0) {
            *material = (int)i;
            return IGI_OK;
        }
    return igi_json_fail(ctx, at, "no material is named \"%s\"; add it to \"materials\"", name);
}

static igi_status material_member(igi_context *ctx, const spec *s, const igi_json *at,
                                  const char *key, int *material)
{
    igi_json member = igi_json_member(at, key);
    return find_material(ctx, s, &member, material);
}

static igi_status add_face(igi_context *ctx, spec *s, const face *f)
{
    face *grown = igi_grow(ctx, s->faces, &s->face_capacity, s->face_count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    s->faces = grown;
    s->faces[s->face_count++] = *f;
    return IGI_OK;
}

/* How often a texture repeats along u and v: whole numbers, so that its mean is the surface's. */
static igi_status read_tile(igi_context *ctx, const igi_json *at, double tile[2])
{
    igi_json tiles = igi_json_member(at, "tile");
    tile[0] = tile[1] = 1;
    if (!tiles.value) return IGI_OK;
    IGI_TRY(igi_json_numbers(ctx, &tiles, 2, tile));
    for (int k = 0; k < 2; k++)
        if (!(tile[k] >= 1 && tile[k] <= 1000 && tile[k] == floor(tile[k])))
            return igi_json_fail(ctx, &tiles, "is %g; give whole numbers from 1 to 1000", tile[k]);
    return IGI_OK;
}

/* A parallelogram, its front where u, v look counter-clockwise. */
static igi_status add_quad(igi_context *ctx, spec *s, int material, const double corner[3],
                           const double u[3], const double v[3], const double tile[2])
{
    face f = {.material = material, .corners = 4};
    for (int c = 0; c < 4; c++) {
        double a = c == 1 || c == 2, b = c >= 2;
        for (int k = 0; k < 3; k++) f.position[c][k] = corner[k] + a * u[k] + b * v[k];
        f.uv[c][0] = a * tile[0];
        f.uv[c][1] = b * tile[1];
    }
    return add_face(ctx, s, &f);
}

/* A rectangle of the plane that `axes` span, from (x0,y0) to (x1,y1). */
static igi_status add_rectangle(igi_context *ctx, spec *s, int material, double z, double x0,
                                double y0, double x1, double y1, bool up)
{
    double corner[3] = {x0, y0, z}, x[3] = {x1 - x0, 0, 0}, y[3] = {0, y1 - y0, 0};
    const double tile[2] = {1, 1};
    if (!(x1 > x0 && y1 > y0)) return IGI_OK;
    return add_quad(ctx, s, material, corner, up ? x : y, up ? y : x, tile);
}

/* The ceiling around its panels: a grid through all their edges. */
static igi_status add_ceiling(igi_context *ctx, spec *s, const igi_json *at, int material,
                              const double size[3])
{
    enum { MOST = 8 };
    static const char *const known[] = {"from", "to", "material"};
    double low[MOST][2], high[MOST][2], xs[2 * MOST + 2] = {0, size[0]},
                                                      ys[2 * MOST + 2] = {0, size[1]};
    int of[MOST] = {0};
    size_t count = 0, lines = 2;
    igi_json panels = igi_json_member(at, "panels");
    if (panels.value) IGI_TRY(igi_json_array(ctx, &panels, &count));
    if (count > MOST) return igi_json_fail(ctx, &panels, "has %zu panels; at most %d", count, MOST);
    for (size_t i = 0; i < count; i++, lines += 2) {
        igi_json panel = igi_json_element(&panels, i);
        igi_json from = igi_json_member(&panel, "from"), to = igi_json_member(&panel, "to");
        IGI_TRY(igi_json_object(ctx, &panel));
        IGI_TRY(igi_json_check_keys(ctx, &panel, known, COUNT(known)));
        IGI_TRY(igi_json_numbers(ctx, &from, 2, low[i]));
        IGI_TRY(igi_json_numbers(ctx, &to, 2, high[i]));
        IGI_TRY(material_member(ctx, s, &panel, "material", &of[i]));
        xs[lines] = low[i][0], xs[lines + 1] = high[i][0];
        ys[lines] = low[i][1], ys[lines + 1] = high[i][1];
    }
    for (size_t i = 1; i < lines; i++) /* insertion sort of a few numbers */
        for (size_t j = i; j > 0; j--) {
            double x = xs[j], y = ys[j];
            if (xs[j - 1] > x) xs[j] = xs[j - 1], xs[j - 1] = x;
            if (ys[j - 1] > y) ys[j] = ys[j - 1], ys[j - 1] = y;
        }
    for (size_t i = 0; i + 1 < lines; i++)
        for (size_t j = 0; j + 1 < lines; j++) {
            double x = (xs[i] + xs[i + 1]) / 2, y = (ys[j] + ys[j + 1]) / 2;
            int which = material;
            for (size_t p = 0; p < count; p++)
                if (x > low[p][0] && x < high[p][0] && y > low[p][1] && y < high[p][1])
                    which = of[p];
            IGI_TRY(
                add_rectangle(ctx, s, which, size[2], xs[i], ys[j], xs[i + 1], ys[j + 1], false));
        }
    return IGI_OK;
}

/* A box seen from inside: floor z = 0, walls south y = 0, north, west x = 0, east. */
static igi_status read_room(igi_context *ctx, spec *s, const igi_json *at)
{
    static const char *const known[] = {"type",  "size",   "floor", "ceiling",
                                        "walls", "panels", "tile"};
    double size[3], tile[2];
    int ground = 0, ceiling = 0, walls[4] = {0};
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, at, "size", size));
    IGI_TRY(material_member(ctx, s, at, "floor", &ground));
    IGI_TRY(material_member(ctx, s, at, "ceiling", &ceiling));
    IGI_TRY(read_tile(ctx, at, tile));
    igi_json wall = igi_json_member(at, "walls");
    size_t count = 4;
    if (json_is_array(wall.value)) IGI_TRY(igi_json_array(ctx, &wall, &count));
    if (count != 4)
        return igi_json_fail(ctx, &wall, "has %zu walls; give south, north, west, east", count);
    for (size_t i = 0; i < 4; i++) {
        igi_json one = igi_json_element(&wall, i);
        IGI_TRY(find_material(ctx, s, json_is_array(wall.value) ? &one : &wall, &walls[i]));
    }
    const double o[3] = {0, 0, 0}, x[3] = {size[0], 0, 0}, y[3] = {0, size[1], 0};
    const double z[3] = {0, 0, size[2]}, far[3] = {size[0], size[1], 0}, one[2] = {1, 1};
    const double west[3] = {-size[0], 0, 0}, south[3] = {0, -size[1], 0};
    IGI_TRY(add_quad(ctx, s, ground, o, x, y, tile));
    IGI_TRY(add_ceiling(ctx, s, at, ceiling, size));
    IGI_TRY(add_quad(ctx, s, walls[0], x, west, z, one)); /* v is up on every wall */
    IGI_TRY(add_quad(ctx, s, walls[1], y, x, z, one));
    IGI_TRY(add_quad(ctx, s, walls[2], o, y, z, one));
    return add_quad(ctx, s, walls[3], far, south, z, one);
}

/* Standing at `at`, the centre of its lower face, turned about the vertical. On the floor it has no
 * lower face, unless "bottom" says so. */
static igi_status read_box(igi_context *ctx, spec *s, const igi_json *at)
{
    static const char *const known[] = {"type", "at", "size", "turn_deg", "material", "bottom"};
    double place[3], size[3], turn = 0;
    const double one[2] = {1, 1};
    bool bottom;
    int material = 0;
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, at, "at", place));
    IGI_TRY(member_vector(ctx, at, "size", size));
    IGI_TRY(material_member(ctx, s, at, "material", &material));
    IGI_TRY(optional_number(ctx, at, "turn_deg", -360, 360, &turn));
    igi_json has_bottom = igi_json_member(at, "bottom");
    bottom = place[2] > 0;
    if (has_bottom.value) IGI_TRY(igi_json_bool(ctx, &has_bottom, &bottom));
    double c = cos(turn * PI / 180), n = sin(turn * PI / 180), p[4][3];
    for (int i = 0; i < 4; i++) { /* counter-clockwise from above */
        double a = (i == 1 || i == 2 ? .5 : -.5) * size[0], b = (i >= 2 ? .5 : -.5) * size[1];
        p[i][0] = place[0] + c * a - n * b;
        p[i][1] = place[1] + n * a + c * b;
        p[i][2] = place[2];
    }
    const double up[3] = {0, 0, size[2]};
    for (int i = 0; i < 4; i++) {
        const double *from = p[i], *to = p[(i + 1) % 4];
        const double side[3] = {to[0] - from[0], to[1] - from[1], 0};
        IGI_TRY(add_quad(ctx, s, material, from, side, up, one));
    }
    const double u[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], 0};
    const double v[3] = {p[3][0] - p[0][0], p[3][1] - p[0][1], 0};
    const double top[3] = {p[0][0], p[0][1], p[0][2] + size[2]};
    IGI_TRY(add_quad(ctx, s, material, top, u, v, one));
    return bottom ? add_quad(ctx, s, material, p[0], v, u, one) : IGI_OK;
}

/* Facets by latitude and longitude, front outside. */
static igi_status read_sphere(igi_context *ctx, spec *s, const igi_json *at)
{
    static const char *const known[] = {"type", "centre", "radius", "around", "rings", "material"};
    double centre[3], radius = -1;
    int around = 48, rings = 24, material = 0;
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, at, "centre", centre));
    IGI_TRY(optional_number(ctx, at, "radius", 1e-6, 1e6, &radius));
    IGI_TRY(optional_int(ctx, at, "around", 3, 1024, &around));
    IGI_TRY(optional_int(ctx, at, "rings", 2, 512, &rings));
    IGI_TRY(material_member(ctx, s, at, "material", &material));
    if (radius < 0) return igi_json_fail(ctx, at, "a sphere needs \"radius\", metres");
    for (int j = 0; j < rings; j++)
        for (int i = 0; i < around; i++) {
            face f = {.material = material, .corners = 4};
            for (int c = 0; c < 4; c++) {
                int ring = j + (c == 1 || c == 2), step = i + (c >= 2);
                double t = PI * ring / rings, phi = 2 * PI * (step % around) / around;
                double rim = ring == 0 || ring == rings ? 0 : sin(t);
                f.position[c][0] = centre[0] + radius * rim * cos(phi);
                f.position[c][1] = centre[1] + radius * rim * sin(phi);
                f.position[c][2] = centre[2] + radius * cos(t);
                f.uv[c][0] = (double)step / around;
                f.uv[c][1] = 1 - (double)ring / rings;
            }
            if (j == 0 || j == rings - 1) { /* a cap: drop the corner that is there twice */
                int twice = j == 0 ? 3 : 2;
                f.corners = 3;
                for (int c = twice; c < 3; c++) {
                    memcpy(f.position[c], f.position[c + 1], sizeof f.position[c]);
                    memcpy(f.uv[c], f.uv[c + 1], sizeof f.uv[c]);
                }
            }
            IGI_TRY(add_face(ctx, s, &f));
        }
    return IGI_OK;
}

static igi_status read_quad(igi_context *ctx, spec *s, const igi_json *at)
{
    static const char *const known[] = {"type", "corner", "u", "v", "tile", "material"};
    double corner[3], u[3], v[3], tile[2];
    int material = 0;
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, at, "corner", corner));
    IGI_TRY(member_vector(ctx, at, "u", u));
    IGI_TRY(member_vector(ctx, at, "v", v));
    IGI_TRY(read_tile(ctx, at, tile));
    IGI_TRY(material_member(ctx, s, at, "material", &material));
    return add_quad(ctx, s, material, corner, u, v, tile);
}

igi_status shape_read(igi_context *ctx, spec *s, const igi_json *at)
{
    igi_json type = igi_json_member(at, "type");
    const char *name;
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_string(ctx, &type, &name));
    if (strcmp(name, "room") == 0) return read_room(ctx, s, at);
    if (strcmp(name, "box") == 0) return read_box(ctx, s, at);
    if (strcmp(name, "sphere") == 0) return read_sphere(ctx, s, at);
    if (strcmp(name, "quad") == 0) return read_quad(ctx, s, at);
    return igi_json_fail(ctx, &type, "no shape is \"%s\"; there are room, box, sphere and quad",
                         name);
}

igi_status shapes_save(igi_context *ctx, const spec *s, const char *path)
{
    igi_file out;
    size_t vertices = 0, uvs = 0;
    int material = -1;
    IGI_TRY(igi_file_begin(ctx, path, &out));
    FILE *file = out.stream;
    fprintf(file, "# metres, +Z up\n");
    for (size_t i = 0; i < s->face_count; i++) {
        const face *f = &s->faces[i];
        bool textured = s->materials->materials[f->material].textured;
        if (f->material != material) {
            material = f->material;
            fprintf(file, "usemtl %s\n", s->materials->materials[material].region);
        }
        for (int c = 0; c < f->corners; c++)
            fprintf(file, "v %.7g %.7g %.7g\n", f->position[c][0], f->position[c][1],
                    f->position[c][2]);
        for (int c = 0; textured && c < f->corners; c++)
            fprintf(file, "vt %.7g %.7g\n", f->uv[c][0], f->uv[c][1]);
        for (int t = 0; t < f->corners - 2; t++) {
            fputc('f', file);
            for (int c = 0; c < 3; c++) {
                size_t corner = c == 0 ? 0 : (size_t)(t + c);
                fprintf(file, " %zu", vertices + corner + 1);
                if (textured) fprintf(file, "/%zu", uvs + corner + 1);
            }
            fputc('\n', file);
        }
        vertices += (size_t)f->corners;
        if (textured) uvs += (size_t)f->corners;
    }
    return igi_file_end(ctx, &out, IGI_OK);
}
