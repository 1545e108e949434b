/* SPDX-License-Identifier: Apache-2.0
 *
 * A colour for each side of each patch. Never seen is magenta, seen once amber, everywhere.
 */
#include "check/sketch.h"

#include <string.h>

const uint8_t igi_never_seen[3] = {208, 28, 122}, igi_seen_once[3] = {245, 166, 35},
              igi_mirrors[3] = {0, 190, 220};

static const uint8_t grey[3] = {150, 150, 150};

static void put(const igi_sketch *s, uint32_t side, const uint8_t rgb[3])
{
    memcpy(s->colours + 3 * (size_t)side, rgb, 3);
}

static size_t sides_of(const igi_sketch *s)
{
    return 2 * s->c->survey->patches->count;
}

/* The region of a side; SIZE_MAX: no such patch. */
static size_t region_of(const igi_sketch *s, uint32_t side)
{
    const igi_patches *patches = s->c->survey->patches;
    return patches->triangle[side >> 1] == IGI_NO_HIT ? SIZE_MAX
                                                      : igi_patch_region(patches, side >> 1);
}

void igi_colour_views(const igi_sketch *s)
{
    static const uint8_t blues[3][3] = {{178, 209, 232}, {104, 160, 208}, {38, 92, 152}};
    for (uint32_t side = 0; side < sides_of(s); side++) {
        int n = s->c->survey->views[side];
        put(s, side,
            n == 0   ? igi_never_seen
            : n == 1 ? igi_seen_once
                     : blues[n < 4   ? 0
                             : n < 8 ? 1
                                     : 2]);
    }
}

void igi_colour_angles(const igi_sketch *s)
{
    for (uint32_t side = 0; side < sides_of(s); side++) {
        float cosine = s->c->survey->cosine[side];
        uint8_t rgb[3];
        igi_ramp_colour(igi_ramp_heat, 1 - acosf(fminf(1, cosine)) * 2 / IGI_PIF, rgb);
        put(s, side, cosine > 0 ? rgb : igi_never_seen);
    }
}

void igi_colour_radiance(const igi_sketch *s)
{
    const igi_survey *survey = s->c->survey;
    int bands = s->c->scene->bands;
    for (uint32_t side = 0; side < sides_of(s); side++) {
        uint8_t rgb[3];
        const uint8_t *mark = survey->views[side] ? igi_seen_once : igi_never_seen;
        for (int c = 0; c < 3; c++) {
            size_t at = (size_t)side * (size_t)bands + (size_t)igi_band_of(c, bands);
            rgb[c] = igi_srgb_byte(&s->page->srgb, s->exposure * survey->radiance[at]);
            if (survey->views[side] == 1) rgb[c] = (uint8_t)((rgb[c] + mark[c]) / 2);
        }
        put(s, side, survey->views[side] ? rgb : mark);
    }
}

void igi_colour_fronts(const igi_sketch *s)
{
    static const uint8_t front[3] = {120, 168, 214}, back[3] = {230, 140, 75};
    for (uint32_t side = 0; side < sides_of(s); side++) put(s, side, side & 1 ? back : front);
}

void igi_colour_albedo(const igi_sketch *s)
{
    int bands = s->c->scene->bands;
    for (uint32_t side = 0; side < sides_of(s); side++) {
        size_t r = region_of(s, side);
        uint8_t rgb[3];
        bool known = r != SIZE_MAX, impossible = false;
        for (int c = 0; c < 3 && known; c++) {
            double rho = s->c->check->regions[r].albedo[igi_band_of(c, bands)];
            known = known && !isnan(rho);
            impossible = impossible || rho > 1.05;
            rgb[c] = igi_srgb_byte(&s->page->srgb, (float)rho);
        }
        put(s, side, impossible ? igi_never_seen : known ? rgb : grey);
    }
}

void igi_colour_highlights(const igi_sketch *s)
{
    for (uint32_t side = 0; side < sides_of(s); side++) {
        size_t r = region_of(s, side);
        const igi_region_check *check = r == SIZE_MAX ? NULL : &s->c->check->regions[r];
        put(s, side,
            !check || check->views == 0       ? grey
            : check->highlights_seen >= 3     ? igi_mirrors
            : check->highlights_predicted > 0 ? igi_seen_once
                                              : igi_never_seen);
    }
}

void igi_colour_shares(const igi_sketch *s, double (*share)(const igi_region_check *), double top)
{
    for (uint32_t side = 0; side < sides_of(s); side++) {
        size_t r = region_of(s, side);
        double x = r == SIZE_MAX ? (double)NAN : share(&s->c->check->regions[r]);
        uint8_t rgb[3];
        igi_ramp_colour(igi_ramp_spread, isnan(x) ? 0 : (float)(.5 + .5 * x / top), rgb);
        put(s, side, isnan(x) ? grey : rgb);
    }
}

igi_status igi_colour_against(const igi_sketch *s, const igi_image *image, const igi_view *view)
{
    const igi_survey *survey = s->c->survey;
    size_t bands = (size_t)s->c->scene->bands;
    double *sums; /* [sides][brightness, pixels] */
    IGI_TRY(IGI_ALLOC(s->c->ctx, 2 * sides_of(s), &sums));
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            const igi_hit *hit = igi_view_hit(view, x, y);
            if (hit->triangle == IGI_NO_HIT) continue;
            uint32_t side = igi_side_at(survey->patches, hit->triangle, hit->u, hit->v, hit->back);
            size_t at = (size_t)y * (size_t)view->width + (size_t)x;
            for (size_t b = 0; b < bands; b++)
                sums[2 * side] += (double)image->samples[at * (size_t)image->channels + b];
            sums[2 * side + 1]++;
        }
    for (uint32_t side = 0; side < sides_of(s); side++) {
        double all = 0;
        uint8_t rgb[3];
        for (size_t b = 0; b < bands; b++) all += (double)survey->radiance[side * bands + b];
        double ratio = sums[2 * side + 1] > 0 && all > 0 ? sums[2 * side] / sums[2 * side + 1] / all
                                                         : (double)NAN;
        igi_ramp_colour(igi_ramp_spread, isnan(ratio) ? 0 : (float)(.5 + (ratio - 1) / .4), rgb);
        put(s, side, isnan(ratio) ? grey : rgb);
    }
    igi_free(sums);
    return IGI_OK;
}
