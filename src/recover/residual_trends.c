/* SPDX-License-Identifier: Apache-2.0
 *
 * Of a region of one albedo, or of a pattern, the albedos a_i of its sides have no trend; light that was
 * forgotten, moved or made up gives them one: a plane is fitted over each region, and its slope compared
 * with what scatter alone would give.
 */
#include "recover/residuals.h"

#include <string.h>

#define FEWEST_SIDES 12
#define PATTERN 0.25 /* share of a pattern's variance that may be a trend */

typedef struct region_sums {
    double weight, mean, sides;
    double centre[3], product[3][3], slope[3]; /* of places, and of places with albedos */
    double square;
} region_sums;

/* Two passes over the sides: means first, then what varies about them. */
static void add_side(const igi_problem *p, const igi_field *field, uint32_t side, double albedo,
                     bool first, region_sums *s)
{
    double w = (double)p->patches->area[side >> 1];
    igi_vec at = igi_field_point(field, side);
    const double place[3] = {(double)at.x, (double)at.y, (double)at.z};
    if (first) {
        s->weight += w;
        s->mean += w * albedo;
        s->sides++;
        for (int k = 0; k < 3; k++) s->centre[k] += w * place[k];
        return;
    }
    double off = albedo / s->mean - 1;
    for (int k = 0; k < 3; k++) {
        s->slope[k] += w * (place[k] - s->centre[k]) * off;
        for (int l = 0; l < 3; l++)
            s->product[k][l] += w * (place[k] - s->centre[k]) * (place[l] - s->centre[l]);
    }
    s->square += w * off * off;
}

/* Solves a x = b for a symmetric matrix by elimination, x in place of b; a direction without extent
 * has no slope. */
static void solve_plane(double a[3][3], double b[3])
{
    double largest = fmax(a[0][0], fmax(a[1][1], a[2][2]));
    for (int k = 0; k < 3; k++) a[k][k] += 1e-4 * largest;
    for (int k = 0; k < 3; k++)
        for (int i = k + 1; i < 3; i++) {
            double factor = a[k][k] > 0 ? a[i][k] / a[k][k] : 0;
            for (int j = k; j < 3; j++) a[i][j] -= factor * a[k][j];
            b[i] -= factor * b[k];
        }
    for (int k = 2; k >= 0; k--) {
        for (int j = k + 1; j < 3; j++) b[k] -= a[k][j] * b[j];
        b[k] = a[k][k] > 0 ? b[k] / a[k][k] : 0;
    }
}

/* Explained variance, less what scatter alone would explain at the most: that is a chi-square of
 * three degrees of freedom, 3 + 3 sqrt(6) at three sigma. The scatter of a pattern is no noise, and
 * some of it may well be a trend. */
static double trend_of(region_sums *s)
{
    double slope[3];
    if (s->sides < FEWEST_SIDES || !(s->weight > 0)) return 0;
    memcpy(slope, s->slope, sizeof slope);
    solve_plane(s->product, slope);
    double explained = 0, all = s->square / s->weight;
    for (int k = 0; k < 3; k++) explained += slope[k] * s->slope[k] / s->weight;
    double rest = fmax(0, all - explained);
    return sqrt(fmax(0, explained - rest * fmax(10.3 / s->sides, PATTERN)));
}

igi_status igi_residuals_find_trends(igi_context *ctx, const igi_problem *p, const igi_field *field,
                                     const igi_materials *m, igi_residuals *out)
{
    region_sums *sums;
    IGI_TRY(IGI_ALLOC(ctx, out->region_count, &sums));
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t side = 0; side < 2 * p->patches->count; side++) {
            double albedo = igi_residual_albedo(p, field, m, side);
            if (albedo < 0) continue;
            region_sums *s = &sums[igi_patch_region(p->patches, side >> 1)];
            if (pass && !(s->mean > 0)) continue;
            add_side(p, field, side, albedo, pass == 0, s);
        }
        for (size_t r = 0; pass == 0 && r < out->region_count; r++) {
            region_sums *s = &sums[r];
            if (!(s->weight > 0)) continue;
            s->mean /= s->weight;
            for (int k = 0; k < 3; k++) s->centre[k] /= s->weight;
        }
    }
    for (size_t r = 0; r < out->region_count; r++) {
        out->regions[r].sides = sums[r].sides;
        out->regions[r].trend = trend_of(&sums[r]);
    }
    igi_free(sums);
    return IGI_OK;
}
