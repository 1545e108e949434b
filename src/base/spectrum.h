/* SPDX-License-Identifier: Apache-2.0
 *
 * Spectra to colours: the CIE 1931 observer, black bodies, XYZ to linear Rec.709 RGB.
 */
#ifndef IGI_SRC_BASE_SPECTRUM_H
#define IGI_SRC_BASE_SPECTRUM_H

/* Lumens of a watt of uniform white light over what is visible (Ward 1994, as Radiance has it):
 * what a band's W m^-2 sr^-1 is worth in cd m^-2, weighted by the band's share of luminance. */
#define IGI_LUMENS_PER_WATT 179.0

/* Colour matching functions of the 2 degree observer at a wavelength in nm (ISO/CIE 11664-1), by
 * the analytic fit of Wyman, Sloan and Shirley (JCGT 2013); xyz[1] is V(lambda). Off from the
 * tables by .015, .008 and .024 at most, of peaks of 1.06, 1 and 1.78. */
void igi_cie_1931(double nm, double xyz[3]);

/* Spectral radiance of a black body, W m^-3 sr^-1 (Planck, CODATA 2018). */
double igi_planck(double nm, double kelvin);

/* Linear RGB of the primaries and the white (D65) of IEC 61966-2-1, from XYZ. */
void igi_rgb_of_xyz(const double xyz[3], double rgb[3]);

/* Its inverse. */
void igi_xyz_of_rgb(const double rgb[3], double xyz[3]);
/* Linear RGB of sRGB's codes in [0,1] (IEC 61966-2-1), and of hue in degrees, saturation and value,
 * which are about those codes (Smith, SIGGRAPH 1978). */
double igi_linear_of_srgb(double code);
void igi_rgb_of_hsv(const double hsv[3], double rgb[3]);
/* Y of linear RGB of those primaries. */
double igi_luminance(const double rgb[3]);

/* Relative power at a wavelength in nm. */
typedef double igi_spectrum_fn(const void *user, double nm);
/* XYZ of a spectrum, 360 to 830 nm in steps of 1 nm; per unit of power, not per 683 lm. */
void igi_xyz_of_spectrum(igi_spectrum_fn *power, const void *user, double xyz[3]);

/* The colour with luminance 1; colours beyond the primaries are clipped to them. */
void igi_colour_of_xyz(const double xyz[3], double rgb[3]);
void igi_colour_of_spectrum(igi_spectrum_fn *power, const void *user, double rgb[3]);
void igi_colour_of_temperature(double kelvin, double rgb[3]);

#endif
