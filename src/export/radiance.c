/* SPDX-License-Identifier: Apache-2.0
 *
 * Radiance. Its `plastic` is Ward's model: diffuse colour times (1 - specularity), an uncoloured
 * lobe of that specularity, and roughness = Ward's alpha; ward comes over as it is, ggx and phong
 * with the alpha of like width. It has no texture coordinates on polygons: a map is a `colorpict`
 * whose coordinates are affine in the point, one for each run of triangles that share them. Points
 * and spots are spheres of a centimetre, since every source there has a size; a spot has no
 * penumbra. Polygons that are lights shine from their front, as igi's do.
 */
#include "export/radiance_private.h"
#include "base/file.h"

#include <math.h>
#include <string.h>

static const char functions[] =
    "{ Coordinates for igi's maps: affine in the point, clamped or repeated; A1..A8, A9 and A10 "
    "are\n"
    "  the sides of the picture over the shorter one. }\n"
    "half = .0005;\n"
    "inside(x) = if(x - half, if(1 - half - x, x, 1 - half), half);\n"
    "fraction(x) = x - floor(x);\n"
    "plane_u = A1*Px + A2*Py + A3*Pz + A4;\n"
    "plane_v = A5*Px + A6*Py + A7*Pz + A8;\n"
    "clamp_u = A9*inside(plane_u);\n"
    "clamp_v = A10*inside(plane_v);\n"
    "wrap_u = A9*inside(fraction(plane_u));\n"
    "wrap_v = A10*inside(fraction(plane_v));\n"
    "{ A sky: +X in the middle, +Y to its left, +Z up; A1 turns it, in radians. }\n"
    "sky_u = A2*inside(fraction(.5 - (atan2(Dy, Dx) - A1)/(2*PI)));\n"
    "sky_v = A3*inside(1 - acos(Dz)/PI);\n";

static igi_status write_functions(const igi_exporter *e)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(e->ctx, &path, "%s/igi.cal", e->folder));
    igi_status status = igi_file_save(e->ctx, path, functions, sizeof functions - 1);
    igi_free(path);
    return status;
}

/* u = m[0..2].P + m[3], v = m[4..6].P + m[7] on the triangle's plane. */
static void find_affine(const igi_mesh *mesh, size_t t, double m[8])
{
    const float *p[3], *uv = mesh->uvs + 6 * t;
    double a[3], b[3], aa = 0, ab = 0, bb = 0;
    for (int k = 0; k < 3; k++)
        p[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k];
    for (int i = 0; i < 3; i++) {
        a[i] = (double)p[1][i] - (double)p[0][i];
        b[i] = (double)p[2][i] - (double)p[0][i];
        aa += a[i] * a[i];
        ab += a[i] * b[i];
        bb += b[i] * b[i];
    }
    double d = aa * bb - ab * ab;
    for (int c = 0; c < 2; c++) {
        double x = (double)uv[2 + c] - (double)uv[c], y = (double)uv[4 + c] - (double)uv[c];
        double s = d > 0 ? (x * bb - y * ab) / d : 0, w = d > 0 ? (y * aa - x * ab) / d : 0;
        m[4 * c + 3] = (double)uv[c];
        for (int i = 0; i < 3; i++) {
            m[4 * c + i] = s * a[i] + w * b[i];
            m[4 * c + 3] -= m[4 * c + i] * (double)p[0][i];
        }
    }
}

static bool is_like(const double a[8], const double b[8])
{
    for (int i = 0; i < 8; i++)
        if (fabs(a[i] - b[i]) > 1e-5 * (1 + fabs(a[i]))) return false;
    return true;
}

static void print_plastic(const igi_exporter *e, size_t region, const char *pattern)
{
    const igi_material *m = &e->materials->materials[region];
    igi_blend b = igi_export_blend(e, region);
    double rgb[3] = {1, 1, 1}, specular = 0;
    if (b.share > 0) specular = (b.specular[0] + b.specular[1] + b.specular[2]) / 3;
    specular = fmin(specular, 0.99);
    if (!igi_export_is_textured(e->scene, m, region))
        igi_export_rgb(m->albedo, e->materials->bands, rgb);
    for (int k = 0; k < 3; k++) rgb[k] /= 1 - specular;
    fprintf(e->file, "%s plastic surface_%zu\n0\n0\n5 %.9g %.9g %.9g %.9g %.9g\n", pattern, region,
            rgb[0], rgb[1], rgb[2], specular, b.share > 0 ? b.alpha : 0);
}

static void print_picture(const igi_exporter *e, size_t region, const char *name, const double m[8])
{
    const igi_image *map = e->materials->materials[region].map;
    const char *way = e->scene->regions[region].uvs_wrap ? "wrap" : "clamp";
    double side = map->width < map->height ? map->width : map->height;
    fprintf(e->file,
            "void colorpict map_%zu\n7 red green blue \"%s/%s.hdr\" %s/igi.cal %s_u %s_v\n0\n10",
            region, e->files, name, e->files, way, way);
    for (int i = 0; i < 8; i++) fprintf(e->file, " %.9g", m[i]);
    fprintf(e->file, " %.9g %.9g\n", map->width / side, map->height / side);
}

static void print_polygon(const igi_exporter *e, size_t region, size_t t)
{
    const igi_mesh *mesh = &e->scene->mesh;
    fprintf(e->file, "surface_%zu polygon triangle_%zu\n0\n0\n9", region, t);
    for (int k = 0; k < 3; k++) {
        const float *p = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k];
        fprintf(e->file, " %.9g %.9g %.9g", (double)p[0], (double)p[1], (double)p[2]);
    }
    putc('\n', e->file);
}

static void print_lamp(const igi_exporter *e, size_t region)
{
    const igi_light *lamp = igi_export_lamp(e, region);
    double rgb[3];
    if (!lamp) {
        fprintf(e->file, "void plastic surface_%zu\n0\n0\n5 0 0 0 0 0\n", region);
        return;
    }
    igi_export_rgb(lamp->value, e->materials->bands, rgb);
    if (lamp->profile > 0)
        fprintf(e->file,
                "void brightfunc profile_%zu\n2 (A1+2)/2*Rdot^A1 .\n0\n1 %.9g\nprofile_%zu", region,
                lamp->profile, region);
    else fputs("void", e->file);
    fprintf(e->file, " light surface_%zu\n0\n0\n3 %.9g %.9g %.9g\n", region, rgb[0], rgb[1],
            rgb[2]);
}

static igi_status print_region(const igi_exporter *e, size_t region)
{
    const igi_mesh *mesh = &e->scene->mesh;
    const igi_material *m = &e->materials->materials[region];
    bool textured = igi_export_is_textured(e->scene, m, region), first = true;
    double affine[8], before[8] = {0};
    char *name = NULL, pattern[32];
    fprintf(e->file, "\n# %s\n", m->region);
    if (textured) IGI_TRY(igi_export_texture(e, region, IGI_PICTURE_HDR, 1));
    else if (m->emitter) print_lamp(e, region);
    else print_plastic(e, region, "void");
    IGI_TRY(igi_region_file_name(e->ctx, m->region, &name));
    snprintf(pattern, sizeof pattern, "map_%zu", region);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->regions[t] != region) continue;
        if (textured) {
            find_affine(mesh, t, affine);
            if (first || !is_like(affine, before)) {
                print_picture(e, region, name, affine);
                print_plastic(e, region, pattern);
                memcpy(before, affine, sizeof before);
            }
            first = false;
        }
        print_polygon(e, region, t);
    }
    igi_free(name);
    return IGI_OK;
}

/* rvu -vf and rpict -vf read these. */
static igi_status write_view(const igi_exporter *e, const igi_frame *frame)
{
    const igi_camera *c = &frame->camera;
    const double(*m)[4] = c->camera_to_world;
    igi_file file;
    char *path = NULL;
    IGI_TRY(igi_strprintf(e->ctx, &path, "%s/%s.vf", e->folder, frame->name));
    igi_status status = igi_file_begin(e->ctx, path, &file);
    if (status == IGI_OK)
        fprintf(file.stream,
                "rvu -vtv -vp %.9g %.9g %.9g -vd %.9g %.9g %.9g -vu %.9g %.9g %.9g -vh %.9g -vv "
                "%.9g -vo 0 -va 0 -vs %.9g -vl %.9g\n",
                m[0][3], m[1][3], m[2][3], -m[0][2], -m[1][2], -m[2][2], m[0][1], m[1][1], m[2][1],
                2 * atan(c->width / (2 * c->fl_x)) * 57.295779513082321,
                2 * atan(c->height / (2 * c->fl_y)) * 57.295779513082321, 0.5 - c->cx / c->width,
                c->cy / c->height - 0.5);
    igi_free(path);
    return igi_file_end(e->ctx, &file, status);
}

static void warn_colours(const igi_exporter *e)
{
    int coloured = 0;
    for (size_t i = 0; i < e->materials->count; i++)
        coloured += e->materials->materials[i].specular_is_rgb;
    if (coloured)
        igi_warn(e->ctx, "Radiance's plastic has a grey lobe: coloured ones become their mean");
}

igi_status igi_write_radiance(const igi_exporter *e)
{
    igi_export_warn_lights(e, "Radiance");
    warn_colours(e);
    fputs("# Radiance scene; views and textures lie beside\n", e->file);
    IGI_TRY(write_functions(e));
    for (size_t i = 0; i < e->frame_count; i++) IGI_TRY(write_view(e, &e->frames[i]));
    for (size_t i = 0; i < e->materials->light_count; i++) IGI_TRY(igi_radiance_light(e, i));
    for (size_t i = 0; i < e->scene->region_count; i++) IGI_TRY(print_region(e, i));
    return IGI_OK;
}
