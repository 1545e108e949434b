/* SPDX-License-Identifier: Apache-2.0
 *
 * Mitsuba 3. Its shapes come from binary PLY, its textures are linear OpenEXR, every surface but a
 * lamp is two-sided. Lobes are blends (blend.c): conductors whose index has no absorption follow
 * Fresnel's curve from the same F0, those of the material "none" reflect alike at every angle.
 */
#include "export/export_private.h"

#include "base/file.h"

#include <math.h>

/* Reflectances above 1 are refused when the file is loaded. */
static void print_reflectance(FILE *f, const char *key, const double rgb[3], double scale)
{
    fprintf(f, "<rgb name=\"%s\" value=\"%.9g %.9g %.9g\"/>", key, fmin(1, rgb[0] * scale),
            fmin(1, rgb[1] * scale), fmin(1, rgb[2] * scale));
}

static void print_rgb(FILE *f, const char *key, const double rgb[3])
{
    fprintf(f, "<rgb name=\"%s\" value=\"%.9g %.9g %.9g\"/>", key, rgb[0], rgb[1], rgb[2]);
}

static void print_lobe(FILE *f, const igi_blend *b)
{
    fprintf(f,
            "<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"%s\"/>"
            "<float name=\"alpha\" value=\"%.9g\"/>",
            b->is_ggx ? "ggx" : "beckmann", b->alpha);
    if (b->has_fresnel) {
        double index[3];
        for (int k = 0; k < 3; k++) index[k] = igi_export_index(b->specular[k]);
        print_rgb(f, "eta", index);
        fprintf(f,
                "<spectrum name=\"k\" value=\"0\"/>"
                "<spectrum name=\"specular_reflectance\" value=\"%.9g\"/>",
                1 / b->share);
    } else {
        fputs("<string name=\"material\" value=\"none\"/>", f);
        print_reflectance(f, "specular_reflectance", b->specular, 1 / b->share);
    }
    fputs("</bsdf>", f);
}

static igi_status print_diffuse(const igi_exporter *e, size_t region, double scale)
{
    const igi_material *m = &e->materials->materials[region];
    double rgb[3];
    char *name = NULL;
    fputs("<bsdf type=\"diffuse\">", e->file);
    if (igi_export_is_textured(e->scene, m, region)) {
        IGI_TRY(igi_export_texture(e, region, IGI_PICTURE_EXR, scale));
        IGI_TRY(igi_region_file_name(e->ctx, m->region, &name));
        fprintf(e->file,
                "<texture type=\"bitmap\" name=\"reflectance\"><boolean name=\"raw\" "
                "value=\"true\"/><string name=\"wrap_mode\" value=\"%s\"/>"
                "<string name=\"filename\" value=\"",
                e->scene->regions[region].uvs_wrap ? "repeat" : "clamp");
        igi_put_escaped(e->file, e->files);
        putc('/', e->file);
        igi_put_escaped(e->file, name);
        fputs(".exr\"/></texture>", e->file);
        igi_free(name);
    } else {
        igi_export_rgb(m->albedo, e->materials->bands, rgb);
        print_reflectance(e->file, "reflectance", rgb, scale);
    }
    fputs("</bsdf>", e->file);
    return IGI_OK;
}

static igi_status print_surface(const igi_exporter *e, size_t region)
{
    FILE *f = e->file;
    igi_blend b = igi_export_blend(e, region);
    fputs("  <bsdf type=\"twosided\">", f);
    if (b.share > 0)
        fprintf(f, "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"%.9g\"/>", b.share);
    IGI_TRY(print_diffuse(e, region, b.diffuse));
    if (b.share > 0) {
        print_lobe(f, &b);
        fputs("</bsdf>", f);
    }
    fputs("</bsdf>\n", f);
    return IGI_OK;
}

static void print_emitter(const igi_exporter *e, size_t region)
{
    const igi_light *lamp = igi_export_lamp(e, region);
    double rgb[3];
    fputs("  <bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0\"/></bsdf>\n", e->file);
    if (!lamp) return;
    igi_export_rgb(lamp->value, e->materials->bands, rgb);
    fputs("  <emitter type=\"area\">", e->file);
    print_rgb(e->file, "radiance", rgb);
    fputs("</emitter>\n", e->file);
}

static igi_status print_shape(const igi_exporter *e, size_t region)
{
    FILE *f = e->file;
    char *name = NULL;
    IGI_TRY(igi_export_ply(e, region));
    IGI_TRY(igi_region_file_name(e->ctx, e->scene->regions[region].name, &name));
    fprintf(f, " <shape type=\"ply\" id=\"region_%zu\">\n  <string name=\"filename\" value=\"",
            region);
    igi_put_escaped(f, e->files);
    putc('/', f);
    igi_put_escaped(f, name);
    igi_free(name);
    fputs(".ply\"/><boolean name=\"face_normals\" value=\"true\"/>"
          "<boolean name=\"flip_tex_coords\" value=\"true\"/>\n",
          f);
    if (e->materials->materials[region].emitter) print_emitter(e, region);
    else IGI_TRY(print_surface(e, region));
    fputs(" </shape>\n", f);
    return IGI_OK;
}

static void print_point(FILE *f, const double at[3], const double rgb[3])
{
    fprintf(f,
            " <emitter type=\"point\"><point name=\"position\" x=\"%.9g\" y=\"%.9g\" "
            "z=\"%.9g\"/>",
            at[0], at[1], at[2]);
    print_rgb(f, "intensity", rgb);
    fputs("</emitter>\n", f);
}

static void print_spot(FILE *f, const igi_light *l, const double rgb[3])
{
    double target[3], up[3];
    igi_export_target(l, target, up);
    fprintf(f,
            " <emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"%.9g, %.9g, "
            "%.9g\" target=\"%.9g, %.9g, %.9g\" up=\"%g, %g, %g\"/></transform><float "
            "name=\"cutoff_angle\" value=\"%.9g\"/><float name=\"beam_width\" value=\"%.9g\"/>",
            l->position[0], l->position[1], l->position[2], target[0], target[1], target[2], up[0],
            up[1], up[2], l->cutoff_deg, l->beam_deg);
    print_rgb(f, "intensity", rgb);
    fputs("</emitter>\n", f);
}

/* Mitsuba's maps are Y-up and have +Z in their middle: its x, y, z are our y, z, x. */
static igi_status print_sky(const igi_exporter *e, size_t light)
{
    double turn = e->materials->lights[light].rotation_deg;
    int size[2];
    IGI_TRY(igi_export_sky(e, light, IGI_PICTURE_EXR, size));
    fputs(" <emitter type=\"envmap\"><string name=\"filename\" value=\"", e->file);
    igi_put_escaped(e->file, e->files);
    fprintf(e->file,
            "/light_%zu.exr\"/><transform name=\"to_world\">"
            "<matrix value=\"0 0 1 0 1 0 0 0 0 1 0 0 0 0 0 1\"/>"
            "<rotate z=\"1\" angle=\"%.9g\"/></transform></emitter>\n",
            light, turn);
    return IGI_OK;
}

static igi_status print_light(const igi_exporter *e, size_t light)
{
    const igi_light *l = &e->materials->lights[light];
    int bands = e->materials->bands;
    double rgb[3], at[3], mean;
    igi_export_rgb(l->value, bands, rgb);
    switch (l->type) {
    case IGI_LIGHT_AREA: break; /* with its shape */
    case IGI_LIGHT_POINT: print_point(e->file, l->position, rgb); break;
    case IGI_LIGHT_SPOT: print_spot(e->file, l, rgb); break;
    case IGI_LIGHT_LINE:
        for (int k = 0; k < IGI_LINE_POINTS; k++) {
            igi_export_line_point(l, k, bands, at, rgb);
            print_point(e->file, at, rgb);
        }
        break;
    case IGI_LIGHT_GONIOMETRIC:
        IGI_TRY(igi_export_mean_intensity(e, l, &mean));
        for (int k = 0; k < 3; k++) rgb[k] *= mean;
        print_point(e->file, l->position, rgb);
        break;
    case IGI_LIGHT_DIRECTIONAL:
        fprintf(e->file,
                " <emitter type=\"directional\"><vector name=\"direction\" x=\"%.9g\" "
                "y=\"%.9g\" z=\"%.9g\"/>",
                l->direction[0], l->direction[1], l->direction[2]);
        print_rgb(e->file, "irradiance", rgb);
        fputs("</emitter>\n", e->file);
        break;
    case IGI_LIGHT_ENV: return print_sky(e, light);
    case IGI_LIGHT_AMBIENT:
        fputs(" <emitter type=\"constant\">", e->file);
        print_rgb(e->file, "radiance", rgb);
        fputs("</emitter>\n", e->file);
        break;
    }
    return IGI_OK;
}

/* OpenGL looks along -Z with +X to the right, Mitsuba along +Z with +X to the left. */
static void print_sensor(FILE *f, const igi_camera *c, size_t number)
{
    fprintf(f,
            " <sensor type=\"perspective\" id=\"view_%zu\"><string name=\"fov_axis\" value=\"x\"/>"
            "<float name=\"fov\" value=\"%.12g\"/><float name=\"principal_point_offset_x\" "
            "value=\"%.9g\"/><float name=\"principal_point_offset_y\" value=\"%.9g\"/>\n"
            "  <float name=\"near_clip\" value=\"0.001\"/><float name=\"far_clip\" "
            "value=\"10000\"/><transform name=\"to_world\"><matrix value=\"",
            number, 2 * atan(c->width / (2 * c->fl_x)) * 57.295779513082321, 0.5 - c->cx / c->width,
            0.5 - c->cy / c->height);
    for (int i = 0; i < 3; i++)
        fprintf(f, "%.12g %.12g %.12g %.12g ", -c->camera_to_world[i][0], c->camera_to_world[i][1],
                -c->camera_to_world[i][2], c->camera_to_world[i][3]);
    fprintf(f,
            "0 0 0 1\"/></transform>\n  <sampler type=\"independent\"><integer "
            "name=\"sample_count\" value=\"$spp\"/></sampler><film type=\"hdrfilm\"><integer "
            "name=\"width\" value=\"%d\"/><integer name=\"height\" value=\"%d\"/><string "
            "name=\"pixel_format\" value=\"rgb\"/><rfilter type=\"box\"/></film></sensor>\n",
            c->width, c->height);
}

static void warn_cameras(const igi_exporter *e)
{
    int bent = 0, stretched = 0;
    for (size_t i = 0; i < e->frame_count; i++) {
        const igi_camera *c = &e->frames[i].camera;
        bent += c->k1 != 0 || c->k2 != 0 || c->k3 != 0 || c->p1 != 0 || c->p2 != 0;
        stretched += fabs(c->fl_x / c->fl_y - 1) > 1e-4;
    }
    if (bent) igi_warn(e->ctx, "the lens's distortion is not exported");
    if (stretched) igi_warn(e->ctx, "Mitsuba's pixels are square: fl_y is taken to be fl_x");
}

igi_status igi_write_mitsuba(const igi_exporter *e)
{
    FILE *f = e->file;
    igi_export_warn_lights(e, "Mitsuba");
    warn_cameras(e);
    fputs("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<scene version=\"3.0.0\">\n"
          " <default name=\"spp\" value=\"64\"/>\n <integrator type=\"path\"><integer "
          "name=\"max_depth\" value=\"64\"/></integrator>\n",
          f);
    for (size_t i = 0; i < e->frame_count; i++) print_sensor(f, &e->frames[i].camera, i);
    for (size_t i = 0; i < e->materials->light_count; i++) IGI_TRY(print_light(e, i));
    for (size_t i = 0; i < e->scene->region_count; i++) IGI_TRY(print_shape(e, i));
    fputs("</scene>\n", f);
    return IGI_OK;
}
