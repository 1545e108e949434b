/* SPDX-License-Identifier: Apache-2.0 */
#include "base/spectrum.h"

#include <math.h>

/* A bell with a width on either side of its peak. */
static double bell(double nm, double peak, double left, double right)
{
    double d = (nm - peak) / (nm < peak ? left : right);
    return exp(-0.5 * d * d);
}

void igi_cie_1931(double nm, double xyz[3])
{
    xyz[0] = 1.056 * bell(nm, 599.8, 37.9, 31.0) + 0.362 * bell(nm, 442.0, 16.0, 26.7) -
             0.065 * bell(nm, 501.1, 20.4, 26.2);
    xyz[1] = 0.821 * bell(nm, 568.8, 46.9, 40.5) + 0.286 * bell(nm, 530.9, 16.3, 31.1);
    xyz[2] = 1.217 * bell(nm, 437.0, 11.8, 36.0) + 0.681 * bell(nm, 459.0, 26.0, 13.8);
}

double igi_planck(double nm, double kelvin)
{
    const double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;
    double m = nm * 1e-9;
    return 2 * h * c * c / pow(m, 5) / expm1(h * c / (m * k * kelvin));
}

void igi_rgb_of_xyz(const double xyz[3], double rgb[3])
{
    static const double matrix[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                        {-0.9692660, 1.8760108, 0.0415560},
                                        {0.0556434, -0.2040259, 1.0572252}};
    for (int i = 0; i < 3; i++)
        rgb[i] = matrix[i][0] * xyz[0] + matrix[i][1] * xyz[1] + matrix[i][2] * xyz[2];
}

double igi_luminance(const double rgb[3])
{
    return 0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2];
}

void igi_xyz_of_spectrum(igi_spectrum_fn *power, const void *user, double xyz[3])
{
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (int nm = 360; nm <= 830; nm++) {
        double observer[3], p = power(user, nm);
        igi_cie_1931(nm, observer);
        for (int i = 0; i < 3; i++) xyz[i] += p * observer[i];
    }
}

void igi_xyz_of_rgb(const double rgb[3], double xyz[3])
{
    static const double matrix[3][3] = {{0.4124564, 0.3575761, 0.1804375},
                                        {0.2126729, 0.7151522, 0.0721750},
                                        {0.0193339, 0.1191920, 0.9503041}};
    for (int i = 0; i < 3; i++)
        xyz[i] = matrix[i][0] * rgb[0] + matrix[i][1] * rgb[1] + matrix[i][2] * rgb[2];
}

double igi_linear_of_srgb(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

void igi_rgb_of_hsv(const double hsv[3], double rgb[3])
{
    for (int i = 0; i < 3; i++) {
        /* Each code is 1 within 60 degrees of its own hue, and 0 beyond 120, before s and v. */
        double away = fabs(fmod(hsv[0] / 60 - 2 * i + 9, 6) - 3); /* in sextants */
        double pure = fmin(1, fmax(0, 2 - away));
        rgb[i] = igi_linear_of_srgb(hsv[2] * (1 - hsv[1] * (1 - pure)));
    }
}

void igi_colour_of_spectrum(igi_spectrum_fn *power, const void *user, double rgb[3])
{
    double xyz[3];
    igi_xyz_of_spectrum(power, user, xyz);
    igi_colour_of_xyz(xyz, rgb);
}

void igi_colour_of_xyz(const double xyz[3], double rgb[3])
{
    igi_rgb_of_xyz(xyz, rgb);
    for (int i = 0; i < 3; i++) rgb[i] = fmax(0, rgb[i]);
    double luminance = igi_luminance(rgb);
    for (int i = 0; i < 3; i++) rgb[i] = luminance > 0 ? rgb[i] / luminance : 1;
}

static double black_body(const void *user, double nm)
{
    const double *kelvin = user;
    return igi_planck(nm, *kelvin);
}

void igi_colour_of_temperature(double kelvin, double rgb[3])
{
    igi_colour_of_spectrum(black_body, &kelvin, rgb);
}
