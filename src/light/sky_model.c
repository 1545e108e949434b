/* SPDX-License-Identifier: Apache-2.0
 *
 * A sky by the sun's place. The clear part is that of Preetham, Shirley and Smits (SIGGRAPH 1999):
 * luminance and chromaticity each
 *     z F(theta, gamma) / F(0, theta_s),   F = (1 + A e^(B/cos theta)) (1 + C e^(D gamma) + E cos^2 gamma)
 * (Perez 1993), theta from the zenith, gamma from the sun, coefficients linear in the turbidity. The
 * overcast part is CIE's (ISO 15469 type 16): L = L_z (1 + 2 sin h) / 3, L_z = 123 + 8600 sin h_sun
 * cd/m^2 (Krochmann and Seidl 1974), white. The sun is a black body of 5778 K through Rayleigh's
 * scattering and Angstrom's aerosol (Iqbal 1983), as broad as the pixels of the map.
 */
#include "light/sky.h"

#include "base/spectrum.h"

#include <math.h>

#define WIDTH 720 /* half a degree, as the sun is broad */
#define HEIGHT 360
#define LUMENS 683.0
#define SUN_KELVIN 5778.0
#define SUN_SOLID_ANGLE 6.794e-5

/* Luminance (kcd/m^2), x and y. */
typedef struct preetham {
    double zenith[3], perez[3][5], sun_theta;
} preetham;

static double perez(const double c[5], double cosine, double gamma)
{
    double g = cos(gamma);
    return (1 + c[0] * exp(c[1] / cosine)) * (1 + c[2] * exp(c[3] * gamma) + c[4] * g * g);
}

static preetham clear_sky(const igi_sky *model)
{
    static const double slopes[3][5] = {{0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
                                        {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
                                        {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109}};
    static const double starts[3][5] = {{-1.4630, 0.4275, 5.3251, -2.5771, 0.3703},
                                        {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452},
                                        {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529}};
    static const double zenith[2][3][4] = {{{0.00166, -0.00375, 0.00209, 0},
                                            {-0.02903, 0.06377, -0.03202, 0.00394},
                                            {0.11693, -0.21196, 0.06052, 0.25886}},
                                           {{0.00275, -0.00610, 0.00317, 0},
                                            {-0.04214, 0.08970, -0.04153, 0.00516},
                                            {0.15346, -0.26756, 0.06670, 0.26688}}};
    preetham p;
    double t = model->turbidity, s = (90 - model->sun_elevation_deg) * IGI_PI / 180;
    p.sun_theta = s;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 5; i++) p.perez[k][i] = slopes[k][i] * t + starts[k][i];
    double chi = (4.0 / 9 - t / 120) * (IGI_PI - 2 * s);
    p.zenith[0] = fmax(0, (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192);
    for (int k = 0; k < 2; k++) {
        double sum[3];
        for (int i = 0; i < 3; i++) {
            const double *z = zenith[k][i];
            sum[i] = ((z[0] * s + z[1]) * s + z[2]) * s + z[3];
        }
        p.zenith[k + 1] = (sum[0] * t + sum[1]) * t + sum[2];
    }
    return p;
}

/* XYZ of the clear sky, cd/m^2 for Y. */
static void clear_xyz(const preetham *p, double cosine, double gamma, double xyz[3])
{
    double v[3];
    cosine = fmax(cosine, 0.01); /* the model has no horizon */
    for (int k = 0; k < 3; k++)
        v[k] = p->zenith[k] * perez(p->perez[k], cosine, gamma) /
               perez(p->perez[k], 1, p->sun_theta);
    xyz[1] = fmax(0, v[0] * 1000);
    xyz[0] = v[1] / v[2] * xyz[1];
    xyz[2] = (1 - v[1] - v[2]) / v[2] * xyz[1];
}

typedef struct sunlight {
    double air_mass, turbidity;
} sunlight;

/* Spectral irradiance at the ground, facing the sun, W m^-2 nm^-1. */
static double sun_power(const void *user, double nm)
{
    const sunlight *s = user;
    double um = nm / 1000, beta = 0.04608 * s->turbidity - 0.04586;
    double rayleigh = exp(-0.008735 * pow(um, -4.08) * s->air_mass);
    double aerosol = exp(-beta * pow(um, -1.3) * s->air_mass);
    return igi_planck(nm, SUN_KELVIN) * 1e-9 * SUN_SOLID_ANGLE * rayleigh * aerosol;
}

static void sun_xyz(const igi_sky *model, double xyz[3])
{
    double h = model->sun_elevation_deg; /* air mass: Kasten 1965 */
    sunlight s = {1 / (sin(h * IGI_PI / 180) + 0.15 * pow(h + 3.885, -1.253)), model->turbidity};
    igi_xyz_of_spectrum(sun_power, &s, xyz);
    for (int k = 0; k < 3; k++) xyz[k] *= LUMENS * (1 - model->cloudiness);
}

/* Adds cd/m^2 (for Y) as radiance; of other than three bands each gets the luminance. */
static void add(const double xyz[3], double share, int bands, float *radiance)
{
    double rgb[3];
    igi_rgb_of_xyz(xyz, rgb);
    for (int b = 0; b < bands; b++)
        radiance[b] += (float)(fmax(0, bands == 3 ? rgb[b] : xyz[1]) * share / IGI_LUMENS_PER_WATT);
}

/* The direction of the map's column and row (also between pixels). */
static igi_vec direction_of(double column, double row)
{
    double phi = (0.5 - column / WIDTH) * 2 * IGI_PI, theta = IGI_PI * row / HEIGHT;
    return igi_v((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta));
}

static void add_dome(const igi_sky *model, igi_vec sun, int bands, float *pixels)
{
    static const double white[3] = {0.95047, 1, 1.08883};
    preetham p = clear_sky(model);
    double zenith = 123 + 8600 * sin(model->sun_elevation_deg * IGI_PI / 180);
    for (int row = 0; row < HEIGHT / 2; row++)
        for (int column = 0; column < WIDTH; column++) {
            float *radiance = pixels + ((size_t)row * WIDTH + (size_t)column) * (size_t)bands;
            igi_vec d = direction_of(column + 0.5, row + 0.5);
            double xyz[3], cosine = (double)d.z;
            clear_xyz(&p, cosine, acos(fmin(1, fmax(-1, (double)igi_dot(d, sun)))), xyz);
            add(xyz, 1 - model->cloudiness, bands, radiance);
            add(white, model->cloudiness * zenith * (1 + 2 * cosine) / 3, bands, radiance);
        }
}

/* Between the four pixels around its place, so that its irradiance is right. */
static void add_sun(const igi_sky *model, int bands, float *pixels)
{
    double xyz[3], azimuth = (90 - model->sun_azimuth_deg) / 360; /* counter-clockwise from +X */
    double x = (0.5 - azimuth) * WIDTH - 0.5;
    double y = (90 - model->sun_elevation_deg) / 180 * HEIGHT - 0.5;
    sun_xyz(model, xyz);
    for (int k = 0; k < 4; k++) {
        int column = (int)floor(x) + k % 2, row = (int)floor(y) + k / 2;
        double share = (1 - fabs(x - column)) * (1 - fabs(y - row));
        column = ((column % WIDTH) + WIDTH) % WIDTH;
        row = row < 0 ? 0 : row >= HEIGHT / 2 ? HEIGHT / 2 - 1 : row;
        double solid = 2 * IGI_PI / WIDTH *
                       (cos(IGI_PI * row / HEIGHT) - cos(IGI_PI * (row + 1) / HEIGHT));
        add(xyz, share / solid, bands,
            pixels + ((size_t)row * WIDTH + (size_t)column) * (size_t)bands);
    }
}

static igi_status make(igi_context *ctx, const igi_sky *model, int bands, double rotation_deg,
                       struct sky **result)
{
    IGI_TRY(sky_create(ctx, WIDTH, HEIGHT, bands, result));
    double h = model->sun_elevation_deg * IGI_PI / 180, a = model->sun_azimuth_deg * IGI_PI / 180;
    igi_vec sun = {(float)(cos(h) * sin(a)), (float)(cos(h) * cos(a)), (float)sin(h)};
    add_dome(model, sun, bands, sky_pixels(*result));
    add_sun(model, bands, sky_pixels(*result));
    sky_finish(*result, rotation_deg);
    return IGI_OK;
}

igi_status sky_of_light(igi_context *ctx, const igi_light *light, int bands, struct sky **result)
{
    *result = NULL;
    if (light->sky.given) return make(ctx, &light->sky, bands, light->rotation_deg, result);
    if (!light->file) return igi_fail(ctx, IGI_E_DATA, "lights: one has no \"image\"");
    return sky_load(ctx, light->file, bands, light->rotation_deg, result);
}
