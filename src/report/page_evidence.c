/* SPDX-License-Identifier: Apache-2.0
 *
 * Why each region was given the model it has.
 */
#include "report/page.h"

#include <igi/report.h>

#include <math.h>
#include <string.h>

static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static const char *text(const json_t *object, const char *key)
{
    const char *value = json_string_value(json_object_get(object, key));
    return value ? value : "";
}

/* The last try of each look is what the next one started from; the best of the last look decided. */
static const json_t *deciding(const json_t *tried, const char *model)
{
    const json_t *best = NULL;
    for (size_t i = 0; i < json_array_size(tried); i++) {
        const json_t *t = json_array_get(tried, i);
        bool is_chosen = strcmp(text(t, "model"), model) == 0;
        if (!best || is_chosen || strcmp(model, "lambert") == 0) best = t;
    }
    return best;
}

static void print_tries(const igi_page *page, const json_t *tried)
{
    FILE *f = page->file;
    const char *look = "";
    for (size_t i = 0; i < json_array_size(tried); i++) {
        const json_t *t = json_array_get(tried, i);
        double share = number(t, "gain") / number(t, "residuals");
        if (strcmp(look, text(t, "look")) != 0) {
            look = text(t, "look");
            fputs(i ? "<br><span class=\"soft\">" : "<span class=\"soft\">", f);
            igi_page_text(page, look);
            fputs(":</span> ", f);
        } else {
            fputs(", ", f);
        }
        igi_page_text(page, text(t, "model"));
        if (isfinite(share)) fprintf(f, "&nbsp;%+.3f", share);
        else fputs("&nbsp;&ndash;", f);
    }
    if (json_array_size(tried) == 0) fputs("nothing", f);
}

/* In words: what speaks for, or against, the lobe that decided. */
static void print_reason(const igi_page *page, const json_t *t, const char *model)
{
    FILE *f = page->file;
    double sigmas = t ? number(t, "specular") / number(t, "specular_std") : (double)NAN;
    bool plain = strcmp(model, "lambert") == 0;
    if (!t) {
        fputs("no lobe was looked for", f);
        return;
    }
    double before = number(t, "plain_noise"), after = number(t, "noise");
    if (!plain) {
        fprintf(f,
                "the lobe explains its highlights: residuals fall from %.2f to %.2f&nbsp;%% of the "
                "light",
                100 * before, 100 * after);
        if (isfinite(sigmas)) fprintf(f, "; &rho;<sub>s</sub> is %.0f&thinsp;&sigma;", sigmas);
        if (json_is_true(json_object_get(t, "coloured")))
            fprintf(
                f,
                "; in each band it has a strength of its own, as metals have, which gains %+.3f "
                "more of a residual",
                number(t, "colour_gain") / number(t, "residuals"));
        return;
    }
    if (!isfinite(number(t, "gain"))) fputs("too few usable pixels to judge by", f);
    else if (strcmp(text(t, "look"), "glance") == 0)
        fprintf(f, "a first look gives no hint of a lobe: without one, residuals are %.2f&nbsp;%%",
                100 * before);
    else if (json_is_true(json_object_get(t, "at_bound")))
        fprintf(f, "the best lobe (&alpha;&nbsp;%.2f) runs into the end of what is looked for",
                number(t, "alpha"));
    else
        fprintf(f,
                "the best lobe (&rho;<sub>s</sub>&nbsp;%.3f, &alpha;&nbsp;%.2f) explains no more "
                "than errors of the irradiance could: residuals %.2f against %.2f&nbsp;%%",
                number(t, "specular"), number(t, "alpha"), 100 * after, 100 * before);
}

/* Why a region has a map, or one albedo. */
static void print_texture(const igi_page *page, const json_t *t)
{
    FILE *f = page->file;
    double amplitude = number(t, "amplitude"), least = number(t, "least");
    bool found = json_is_true(json_object_get(t, "found"));
    if (!t) return;
    fputs("<br>", f);
    if (json_is_true(json_object_get(t, "given")))
        fprintf(f, "scene.json says that it has %s texture", found ? "a" : "no");
    else if (!isfinite(amplitude)) fputs("too little is seen to tell a texture by: one albedo", f);
    else if (found)
        fprintf(f,
                "a texture: both halves of the photographs show deviations of %.1f&nbsp;%%, more "
                "than the %.1f&nbsp;%% that errors of the light could be",
                100 * amplitude, 100 * least);
    else if (amplitude > least)
        fprintf(
            f, "one albedo: halves of the photographs disagree on its deviations (by %.0f&nbsp;%%)",
            100 * (1 - number(t, "agreement")));
    else
        fprintf(f,
                "one albedo: deviations of %.1f&nbsp;%%, and errors of the light could be "
                "%.1f&nbsp;%%",
                100 * amplitude, 100 * least);
}

/* In a cell of its own; the last one is left open. */
static void print_thousands(FILE *f, double x)
{
    if (isnan(x)) fputs("</td><td>&ndash;", f);
    else fprintf(f, "</td><td>%.1f", x * 1e-3);
}

static void print_row(const igi_page *page, const char *name, const json_t *region)
{
    FILE *f = page->file;
    const json_t *tried = json_object_get(region, "tried");
    double texels = number(region, "texels");
    fputs("<tr><td class=\"l\">", f);
    igi_page_text(page, name);
    fputs("</td><td class=\"l\">", f);
    igi_page_text(page, text(region, "model"));
    fputs("</td><td class=\"l wide\">", f);
    print_tries(page, tried);
    fputs("</td><td class=\"l wide\">", f);
    print_reason(page, deciding(tried, text(region, "model")), text(region, "model"));
    print_texture(page, json_object_get(region, "texture"));
    fprintf(f, "</td><td>%.0f</td><td>", number(region, "parameters"));
    if (texels > 0) fprintf(f, "%.0f", texels);
    else fputs("&ndash;", f);
    print_thousands(f, number(region, "gathered_rays"));
    print_thousands(f, number(region, "lobe_rays"));
    fputs("</td></tr>\n", f);
}

static void print_totals(const igi_page *page, json_t *regions)
{
    static const char *const keys[] = {"parameters", "texels", "gathered_rays", "lobe_rays"};
    double sums[4] = {0, 0, 0, 0};
    for (void *it = json_object_iter(regions); it; it = json_object_iter_next(regions, it))
        for (int k = 0; k < 4; k++)
            sums[k] += json_number_value(json_object_get(json_object_iter_value(it), keys[k]));
    fprintf(page->file,
            "</tbody><tfoot><tr><th class=\"l\" colspan=\"4\">all</th><td>%.0f</td><td>%.0f</td>"
            "<td>%.1f</td><td>%.1f</td></tr></tfoot>",
            sums[0], sums[1], sums[2] * 1e-3, sums[3] * 1e-3);
}

igi_status igi_page_evidence(const igi_page *page)
{
    FILE *f = page->file;
    json_t *regions = json_object_get(page->evidence, "regions");
    fputs(
        "<section id=\"evidence\"><h2>Evidence</h2><p class=\"soft\">A lobe, or a texture in place "
        "of one albedo, is given only where the photographs "
        "ask for it. Tried: what each model gains over none, as &minus;2&thinsp;ln likelihood for "
        "each residual (a residual: one pixel's difference from the model); glance, search and "
        "refine look with ever more pixels. Parameters: an albedo for each band, and two of a "
        "lobe; "
        "texels come on top where the region is textured.</p><div class=\"card "
        "scroll\" tabindex=\"0\"><table><thead><tr><th class=\"l\">region"
        "</th><th class=\"l\">given</th><th class=\"l\">tried</th><th class=\"l\">why</th>"
        "<th>parameters</th><th>texels</th><th>rays for its<br>light, 10<sup>3</sup></th>"
        "<th>for its<br>lobe, 10<sup>3</sup></th></tr></thead><tbody>\n",
        f);
    for (void *it = json_object_iter(regions); it; it = json_object_iter_next(regions, it))
        print_row(page, json_object_iter_key(it), json_object_iter_value(it));
    print_totals(page, regions);
    fputs("</table></div></section>\n", f);
    return IGI_OK;
}
