/* SPDX-License-Identifier: Apache-2.0
 *
 * Radiance's sources have a size: an intensity I becomes a sphere of radius r and radiance
 * I/(pi r^2), an irradiance E a disk of the sky with radiance E/(pi sin^2 of half its angle).
 */
#include "export/radiance_private.h"

#include <math.h>

#define RADIUS 0.01   /* metres */
#define SUN_ANGLE 0.1 /* degrees across */
#define PI 3.14159265358979323846

static void print_sphere(FILE *f, size_t light, int part, const double at[3])
{
    fprintf(f, "light_%zu sphere source_%zu_%d\n0\n0\n4 %.9g %.9g %.9g %g\n", light, light, part,
            at[0], at[1], at[2], RADIUS);
}

static void print_light(FILE *f, size_t light, const double rgb[3], double scale)
{
    fprintf(f, "void light light_%zu\n0\n0\n3 %.9g %.9g %.9g\n", light, rgb[0] * scale,
            rgb[1] * scale, rgb[2] * scale);
}

static void print_line(const igi_exporter *e, size_t light)
{
    const igi_light *l = &e->materials->lights[light];
    double at[3], rgb[3];
    igi_export_line_point(l, 0, e->materials->bands, at, rgb);
    print_light(e->file, light, rgb, 1 / (PI * RADIUS * RADIUS));
    for (int k = 0; k < IGI_LINE_POINTS; k++) {
        igi_export_line_point(l, k, e->materials->bands, at, rgb);
        print_sphere(e->file, light, k, at);
    }
}

/* The full angle, in degrees, of the cone that sends out as much light as the spot, whose intensity
 * falls linearly between the half angles b and c: 1 - cos of its half is 1 - (sin c - sin b)/(c - b). */
static double cone_angle(const igi_light *l)
{
    double b = l->beam_deg * PI / 180, c = l->cutoff_deg * PI / 180;
    return c - b > 1e-6 ? 2 * acos((sin(c) - sin(b)) / (c - b)) * 180 / PI : 2 * l->cutoff_deg;
}

/* The direction's length is how far behind
 * the source the cone has its tip. */
static void print_spot(FILE *f, size_t light, const igi_light *l, const double rgb[3])
{
    double scale = 1 / (PI * RADIUS * RADIUS);
    fprintf(f, "void spotlight light_%zu\n0\n0\n7 %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", light,
            rgb[0] * scale, rgb[1] * scale, rgb[2] * scale, cone_angle(l), 1e-4 * l->direction[0],
            1e-4 * l->direction[1], 1e-4 * l->direction[2]);
    print_sphere(f, light, 0, l->position);
}

static void print_sun(FILE *f, size_t light, const igi_light *l, const double rgb[3])
{
    double sine = sin(SUN_ANGLE / 2 * PI / 180);
    print_light(f, light, rgb, 1 / (PI * sine * sine));
    fprintf(f, "light_%zu source source_%zu\n0\n0\n4 %.9g %.9g %.9g %g\n", light, light,
            -l->direction[0], -l->direction[1], -l->direction[2], SUN_ANGLE);
}

static void print_glow(FILE *f, size_t light, const char *pattern, const double rgb[3])
{
    fprintf(f,
            "%s glow light_%zu\n0\n0\n4 %.9g %.9g %.9g 0\n"
            "light_%zu source source_%zu\n0\n0\n4 0 0 1 360\n",
            pattern, light, rgb[0], rgb[1], rgb[2], light, light);
}

static igi_status print_sky(const igi_exporter *e, size_t light)
{
    static const double one[3] = {1, 1, 1};
    char pattern[32];
    int size[2];
    IGI_TRY(igi_export_sky(e, light, IGI_PICTURE_HDR, size));
    double side = size[0] < size[1] ? size[0] : size[1];
    snprintf(pattern, sizeof pattern, "sky_%zu", light);
    fprintf(e->file,
            "void colorpict %s\n7 red green blue %s/light_%zu.hdr %s/igi.cal sky_u sky_v\n0\n"
            "3 %.9g %.9g %.9g\n",
            pattern, e->files, light, e->files, e->materials->lights[light].rotation_deg * PI / 180,
            size[0] / side, size[1] / side);
    print_glow(e->file, light, pattern, one);
    return IGI_OK;
}

igi_status igi_radiance_light(const igi_exporter *e, size_t light)
{
    const igi_light *l = &e->materials->lights[light];
    FILE *f = e->file;
    double rgb[3], mean = 1;
    igi_export_rgb(l->value, e->materials->bands, rgb);
    switch (l->type) {
    case IGI_LIGHT_AREA: break; /* with its surface */
    case IGI_LIGHT_GONIOMETRIC:
        IGI_TRY(igi_export_mean_intensity(e, l, &mean));
        print_light(f, light, rgb, mean / (PI * RADIUS * RADIUS));
        print_sphere(f, light, 0, l->position);
        break;
    case IGI_LIGHT_POINT:
        print_light(f, light, rgb, 1 / (PI * RADIUS * RADIUS));
        print_sphere(f, light, 0, l->position);
        break;
    case IGI_LIGHT_SPOT: print_spot(f, light, l, rgb); break;
    case IGI_LIGHT_LINE: print_line(e, light); break;
    case IGI_LIGHT_DIRECTIONAL: print_sun(f, light, l, rgb); break;
    case IGI_LIGHT_ENV: return print_sky(e, light);
    case IGI_LIGHT_AMBIENT: print_glow(f, light, "void", rgb); break;
    }
    return IGI_OK;
}
