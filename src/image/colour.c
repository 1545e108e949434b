/* SPDX-License-Identifier: Apache-2.0
 *
 * From the primaries that a file names to Rec.709.
 *
 * With columns P = (x, y, 1-x-y) of the three primaries and W = white / y_white, the weights s of
 * P s = W make RGB = (1,1,1) white, and XYZ = P diag(s) RGB (SMPTE RP 177). Nothing divides by a
 * primary's own y, so that files whose "primaries" are X, Y and Z themselves come out right.
 */
#include "image/image_private.h"

#include <math.h>

const igi_chromaticities igi_rec709 = {
    {{.6400, .3300}, {.3000, .6000}, {.1500, .0600}, {.3127, .3290}}};

static bool invert(double a[3][3], double inverse[3][3])
{
    double cofactor[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
        }
    double determinant = 0;
    for (int j = 0; j < 3; j++) determinant += a[0][j] * cofactor[0][j];
    if (!isfinite(determinant) || fabs(determinant) < 1e-9) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse[i][j] = cofactor[j][i] / determinant;
    return true;
}

bool igi_rgb_to_xyz(const igi_chromaticities *chromaticities, double m[3][3])
{
    double primaries[3][3], inverse[3][3];
    const double(*xy)[2] = chromaticities->xy;
    for (int c = 0; c < 3; c++) {
        primaries[0][c] = xy[c][0];
        primaries[1][c] = xy[c][1];
        primaries[2][c] = 1 - xy[c][0] - xy[c][1];
    }
    if (!(fabs(xy[3][1]) > 1e-6) || !invert(primaries, inverse)) return false;
    double white[3] = {xy[3][0] / xy[3][1], 1, (1 - xy[3][0] - xy[3][1]) / xy[3][1]};
    for (int c = 0; c < 3; c++) {
        double weight = 0;
        for (int k = 0; k < 3; k++) weight += inverse[c][k] * white[k];
        if (!isfinite(weight)) return false;
        for (int i = 0; i < 3; i++) m[i][c] = primaries[i][c] * weight;
    }
    return true;
}

bool igi_rgb_to_rec709(const igi_chromaticities *chromaticities, double m[3][3])
{
    double source[3][3], rec709[3][3], inverse[3][3];
    if (!igi_rgb_to_xyz(chromaticities, source) || !igi_rgb_to_xyz(&igi_rec709, rec709) ||
        !invert(rec709, inverse))
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            m[i][j] = 0;
            for (int k = 0; k < 3; k++) m[i][j] += inverse[i][k] * source[k][j];
        }
    return true;
}
