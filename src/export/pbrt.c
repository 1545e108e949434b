/* SPDX-License-Identifier: Apache-2.0
 *
 * pbrt-v4, by its file format's manual (pbrt.org/fileformat-v4). One view: the first; the other
 * cameras follow as comments. The screen window of a 90 degree camera holds what a pinhole of any
 * fl_x, fl_y, cx, cy sees. Lobes are `mix`tures of `diffuse` and `conductor` (blend.c); a
 * conductor's reflectance is that at normal incidence and rises to 1 with the angle, so that ward
 * and phong lobes are exact only where the mixture's share equals rho_s: there it is 1 everywhere.
 */
#include "export/export_private.h"

#include <math.h>

static void print_rgb(FILE *f, const char *key, const double rgb[3], double scale)
{
    fprintf(f, " \"rgb %s\" [ %.9g %.9g %.9g ]", key, rgb[0] * scale, rgb[1] * scale,
            rgb[2] * scale);
}

static void print_reflectance(FILE *f, const double rgb[3], double scale)
{
    double clamped[3];
    for (int k = 0; k < 3; k++) clamped[k] = fmin(1, rgb[k] * scale);
    print_rgb(f, "reflectance", clamped, 1);
}

static igi_status print_texture(const igi_exporter *e, size_t region, double scale)
{
    char *name = NULL;
    IGI_TRY(igi_export_texture(e, region, IGI_PICTURE_EXR, scale));
    IGI_TRY(igi_region_file_name(e->ctx, e->scene->regions[region].name, &name));
    fprintf(e->file,
            "Texture \"map_%zu\" \"spectrum\" \"imagemap\" \"string filename\" \"%s/%s.exr\" "
            "\"string encoding\" \"linear\" \"string wrap\" \"%s\"\n",
            region, e->files, name, e->scene->regions[region].uvs_wrap ? "repeat" : "clamp");
    igi_free(name);
    return IGI_OK;
}

static igi_status print_material(const igi_exporter *e, size_t region)
{
    FILE *f = e->file;
    const igi_material *m = &e->materials->materials[region];
    igi_blend b = igi_export_blend(e, region);
    double rgb[3];
    bool textured = igi_export_is_textured(e->scene, m, region);
    if (textured) IGI_TRY(print_texture(e, region, b.diffuse));
    igi_export_rgb(m->albedo, e->materials->bands, rgb);
    fprintf(f, "MakeNamedMaterial \"diffuse_%zu\" \"string type\" \"diffuse\"", region);
    if (textured) fprintf(f, " \"texture reflectance\" \"map_%zu\"", region);
    else print_reflectance(f, rgb, b.diffuse);
    putc('\n', f);
    if (b.share > 0) {
        fprintf(f,
                "MakeNamedMaterial \"lobe_%zu\" \"string type\" \"conductor\" \"float roughness\" "
                "%.9g \"bool remaproughness\" false",
                region, b.alpha);
        print_reflectance(f, b.specular, 1 / b.share);
        fprintf(f,
                "\nMakeNamedMaterial \"surface_%zu\" \"string type\" \"mix\" \"string materials\" "
                "[ \"diffuse_%zu\" \"lobe_%zu\" ] \"float amount\" %.9g\n",
                region, region, region, b.share);
    }
    fprintf(f, "NamedMaterial \"%s_%zu\"\n", b.share > 0 ? "surface" : "diffuse", region);
    return IGI_OK;
}

static igi_status print_shape(const igi_exporter *e, size_t region)
{
    FILE *f = e->file;
    char *name = NULL;
    const igi_light *lamp = igi_export_lamp(e, region);
    double rgb[3];
    IGI_TRY(igi_export_ply(e, region));
    fputs("AttributeBegin\n", f);
    if (e->materials->materials[region].emitter) {
        fputs("Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n", f);
        if (lamp) {
            igi_export_rgb(lamp->value, e->materials->bands, rgb);
            fputs("AreaLightSource \"diffuse\"", f);
            print_rgb(f, "L", rgb, 1);
            putc('\n', f);
        }
    } else {
        IGI_TRY(print_material(e, region));
    }
    IGI_TRY(igi_region_file_name(e->ctx, e->scene->regions[region].name, &name));
    fprintf(f, "Shape \"plymesh\" \"string filename\" \"%s/%s.ply\"\nAttributeEnd\n", e->files,
            name);
    igi_free(name);
    return IGI_OK;
}

static void print_point(FILE *f, const double at[3], const double rgb[3])
{
    fprintf(f, "LightSource \"point\" \"point3 from\" [ %.9g %.9g %.9g ]", at[0], at[1], at[2]);
    print_rgb(f, "I", rgb, 1);
    putc('\n', f);
}

static void print_spot(FILE *f, const igi_light *l, const double rgb[3])
{
    double target[3], up[3];
    igi_export_target(l, target, up);
    fprintf(f,
            "LightSource \"spot\" \"point3 from\" [ %.9g %.9g %.9g ] \"point3 to\" [ %.9g %.9g "
            "%.9g ] \"float coneangle\" %.9g \"float conedeltaangle\" %.9g",
            l->position[0], l->position[1], l->position[2], target[0], target[1], target[2],
            l->cutoff_deg, l->cutoff_deg - l->beam_deg);
    print_rgb(f, "I", rgb, 1);
    putc('\n', f);
}

static igi_status print_light(const igi_exporter *e, size_t light)
{
    FILE *f = e->file;
    const igi_light *l = &e->materials->lights[light];
    const double *d = l->direction;
    int bands = e->materials->bands;
    double rgb[3], at[3], mean;
    igi_export_rgb(l->value, bands, rgb);
    switch (l->type) {
    case IGI_LIGHT_AREA: break; /* with its shape */
    case IGI_LIGHT_POINT: print_point(f, l->position, rgb); break;
    case IGI_LIGHT_SPOT: print_spot(f, l, rgb); break;
    case IGI_LIGHT_LINE:
        for (int k = 0; k < IGI_LINE_POINTS; k++) {
            igi_export_line_point(l, k, bands, at, rgb);
            print_point(f, at, rgb);
        }
        break;
    case IGI_LIGHT_GONIOMETRIC:
        IGI_TRY(igi_export_mean_intensity(e, l, &mean));
        for (int k = 0; k < 3; k++) rgb[k] *= mean;
        print_point(f, l->position, rgb);
        break;
    case IGI_LIGHT_DIRECTIONAL:
        fprintf(f,
                "LightSource \"distant\" \"point3 from\" [ 0 0 0 ] \"point3 to\" [ %.9g %.9g %.9g "
                "]",
                d[0], d[1], d[2]);
        print_rgb(f, "L", rgb, 1);
        putc('\n', f);
        break;
    case IGI_LIGHT_ENV:
        IGI_TRY(igi_export_square_sky(e, light));
        fprintf(f, "LightSource \"infinite\" \"string filename\" \"%s/light_%zu.exr\"\n", e->files,
                light);
        break;
    case IGI_LIGHT_AMBIENT:
        fputs("LightSource \"infinite\"", f);
        print_rgb(f, "L", rgb, 1);
        putc('\n', f);
        break;
    }
    return IGI_OK;
}

/* World to camera, column by column: +X right, +Y up, +Z forward. */
static void print_camera(FILE *f, const igi_frame *frame, const char *comment)
{
    const igi_camera *c = &frame->camera;
    static const double sign[3] = {1, 1, -1};
    double shift[3];
    fprintf(f, "%sTransform [", comment);
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++)
            fprintf(f, " %.12g", sign[row] * c->camera_to_world[column][row]);
        fputs(" 0", f);
    }
    for (int row = 0; row < 3; row++) {
        shift[row] = 0;
        for (int k = 0; k < 3; k++)
            shift[row] -= sign[row] * c->camera_to_world[k][row] * c->camera_to_world[k][3];
    }
    fprintf(f, " %.12g %.12g %.12g 1 ]\n", shift[0], shift[1], shift[2]);
    fprintf(f,
            "%sCamera \"perspective\" \"float fov\" 90 \"float screenwindow\" [ %.12g %.12g %.12g "
            "%.12g ]\n",
            comment, -c->cx / c->fl_x, (c->width - c->cx) / c->fl_x, (c->cy - c->height) / c->fl_y,
            c->cy / c->fl_y);
    fprintf(f,
            "%sFilm \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d \"string "
            "filename\" \"%s.exr\"\n",
            comment, c->width, c->height, frame->name);
}

igi_status igi_write_pbrt(const igi_exporter *e)
{
    FILE *f = e->file;
    igi_export_warn_lights(e, "pbrt");
    fputs("# pbrt-v4\nIntegrator \"volpath\" \"integer maxdepth\" 64\n"
          "Sampler \"zsobol\" \"integer pixelsamples\" 64\nPixelFilter \"box\"\n",
          f);
    for (size_t i = 0; i < e->frame_count; i++) print_camera(f, &e->frames[i], i == 0 ? "" : "# ");
    fputs("WorldBegin\n", f);
    for (size_t i = 0; i < e->materials->light_count; i++) IGI_TRY(print_light(e, i));
    for (size_t i = 0; i < e->scene->region_count; i++) IGI_TRY(print_shape(e, i));
    return IGI_OK;
}
