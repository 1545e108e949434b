/* SPDX-License-Identifier: Apache-2.0
 *
 * A ball of every material, beside that of its truth where it is known.
 */
#include "report/page.h"

#include "report/sphere.h"

#include <math.h>
#include <string.h>

enum { SPHERE_SIDE = 88 };

static const igi_material *truth_of(const igi_page *page, const char *region)
{
    for (size_t i = 0; page->truth && i < page->truth->count; i++)
        if (strcmp(page->truth->materials[i].region, region) == 0)
            return &page->truth->materials[i];
    return NULL;
}

/* Red, green, blue and coverage, in eight bits each. */
static igi_status print_ball(const igi_page *page, const igi_material *m, const char *label)
{
    igi_status status = IGI_OK;
    igi_image *ball = NULL;
    uint8_t *pixels = NULL;
    int bands = page->materials->bands;
    IGI_TRY_GOTO(igi_sphere_draw(page->ctx, m, bands, SPHERE_SIDE, &ball));
    IGI_TRY_GOTO(IGI_ALLOC(page->ctx, 4 * (size_t)SPHERE_SIDE * SPHERE_SIDE, &pixels));
    for (size_t i = 0; i < (size_t)SPHERE_SIDE * SPHERE_SIDE; i++) {
        const float *from = ball->samples + i * ((size_t)bands + 1);
        for (int c = 0; c < 3; c++)
            pixels[4 * i + (size_t)c] = igi_srgb_byte(&page->srgb, from[igi_band_of(c, bands)]);
        pixels[4 * i + 3] = (uint8_t)lrintf(255 * from[bands]);
    }
    IGI_TRY_GOTO(igi_page_pixels(page, pixels, SPHERE_SIDE, SPHERE_SIDE, 4, label));
cleanup:
    igi_image_destroy(ball);
    igi_free(pixels);
    return status;
}

static void print_numbers(const igi_page *page, const igi_material *m, bool with_sigma)
{
    FILE *f = page->file;
    double mean = 0, sigma = 0;
    int bands = page->materials->bands;
    for (int b = 0; b < bands; b++) {
        mean += m->albedo[b] / bands;
        sigma = fmax(sigma, m->albedo_std[b]);
    }
    fprintf(f, "%s, &rho;&nbsp;%.3f", igi_model_name(m->model), mean);
    if (with_sigma && m->determined) fprintf(f, "&nbsp;&plusmn;&nbsp;%.1g", sigma);
    if (m->model == IGI_LAMBERT) return;
    fprintf(f, ", &rho;<sub>s</sub>&nbsp;%.3f", m->specular);
    if (with_sigma) fprintf(f, "&nbsp;&plusmn;&nbsp;%.1g", m->specular_std);
    fprintf(f, ", &alpha;&nbsp;%.3f", m->alpha);
    if (with_sigma) fprintf(f, "&nbsp;&plusmn;&nbsp;%.1g", m->alpha_std);
}

static igi_status print_card(const igi_page *page, const igi_material *m)
{
    const igi_material *truth = truth_of(page, m->region);
    FILE *f = page->file;
    char *label;
    fputs("<div class=\"card ball\"><div>", f);
    IGI_TRY(igi_strprintf(page->ctx, &label, "a ball of %s", m->region));
    igi_status status = print_ball(page, m, label);
    igi_free(label);
    IGI_TRY(status);
    if (truth) IGI_TRY(print_ball(page, truth, "its truth"));
    fputs("</div><h3>", f);
    igi_page_text(page, m->region);
    fputs("</h3><p class=\"soft\">", f);
    print_numbers(page, m, true);
    if (truth) {
        fputs("<br>truth: ", f);
        print_numbers(page, truth, false);
    }
    fputs("</p></div>\n", f);
    return IGI_OK;
}

igi_status igi_page_spheres(const igi_page *page)
{
    fprintf(page->file,
            "<section id=\"balls\"><h2>Balls</h2><p class=\"soft\">Each material on a ball, of its "
            "mean albedo, under the same soft box%s.</p><div class=\"balls\">\n",
            page->truth ? ": recovered on the left, its truth on the right (of a texture that "
                          "the photographs show in part, the means are of that part, and of all)"
                        : "");
    for (size_t i = 0; i < page->materials->count; i++)
        if (!page->materials->materials[i].emitter)
            IGI_TRY(print_card(page, &page->materials->materials[i]));
    fputs("</div></section>\n", page->file);
    return IGI_OK;
}
