/* SPDX-License-Identifier: Apache-2.0
 *
 * The table of regions.
 */
#include "report/page.h"

#include <math.h>

double igi_material_share(const igi_material *material, int bands)
{
    double largest = 0;
    for (int b = 0; b < bands; b++) {
        double floor = fmax(material->albedo[b], 0.02); /* as errors are reckoned */
        largest = fmax(largest, material->albedo_std[b] / floor);
    }
    return largest;
}

static void print_swatch(const igi_page *page, const igi_material *m)
{
    uint8_t rgb[3];
    for (int c = 0; c < 3; c++) {
        int band = igi_band_of(c, page->materials->bands);
        rgb[c] = igi_srgb_byte(&page->srgb, (float)m->albedo[band]);
    }
    fprintf(page->file, "<span class=\"swatch\" style=\"background:#%02x%02x%02x\"></span>", rgb[0],
            rgb[1], rgb[2]);
}

static void print_lobe(const igi_page *page, const igi_material *m)
{
    FILE *f = page->file;
    if (m->model == IGI_LAMBERT) {
        fputs("<td data-v=\"0\">&ndash;</td><td data-v=\"0\">&ndash;</td>", f);
        return;
    }
    fprintf(f, "<td data-v=\"%.6g\">%.4f <span class=\"soft\">&plusmn; %.1g</span>", m->specular,
            m->specular, m->specular_std);
    for (int b = 0; b < page->materials->bands && m->specular_is_rgb; b++)
        fprintf(f, "%s%.3f <span class=\"soft\">&plusmn; %.1g</span>", b ? ", " : "<br>",
                m->specular_rgb[b], m->specular_rgb_std[b]);
    fputs("</td>", f);
    fprintf(f, "<td data-v=\"%.6g\">%.4f <span class=\"soft\">&plusmn; %.1g</span></td>", m->alpha,
            m->alpha, m->alpha_std);
}

static void print_row(const igi_page *page, const igi_material *m, bool lobes)
{
    FILE *f = page->file;
    int bands = page->materials->bands;
    double share = igi_material_share(m, bands);
    fprintf(f, "<tr%s><td class=\"l\">", m->determined ? "" : " class=\"unknown\"");
    print_swatch(page, m);
    fputs("</td><td class=\"l\">", f);
    igi_page_text(page, m->region);
    fprintf(f, "</td><td class=\"l\">%s</td>", igi_model_name(m->model));
    for (int b = 0; b < bands; b++)
        fprintf(f, "<td data-v=\"%.6g\">%.4f</td>", m->albedo[b], m->albedo[b]);
    fprintf(f, "<td data-v=\"%.6g\">", isfinite(share) ? share : 1e9);
    if (m->determined) igi_page_percent(page, share);
    else fputs("not seen", f);
    fputs("</td>", f);
    if (lobes) print_lobe(page, m);
    fprintf(f,
            "<td data-v=\"%.6g\"><span class=\"meter\"><i style=\"width:%.0f%%\"></i></span>"
            "<span class=\"share\">%.0f&nbsp;%%</span></td><td data-v=\"%d\">%d</td></tr>\n",
            m->observed, 100 * m->observed, 100 * m->observed, m->views, m->views);
}

/* In a row below the region's, which stays there when the table is sorted. */
static void print_notes(const igi_page *page, const igi_material *m, bool lobes)
{
    FILE *f = page->file;
    if (m->warning_count == 0) return;
    fprintf(f, "<tr class=\"more\"><td></td><td class=\"l note\" colspan=\"%d\">",
            5 + page->materials->bands + 2 * lobes);
    for (size_t i = 0; i < m->warning_count; i++) {
        fputs(i ? "<br>" : "", f);
        igi_page_text(page, m->warnings[i]);
    }
    fputs("</td></tr>\n", f);
}

static void print_heading(FILE *f, const char *label, bool left)
{
    fprintf(f, "<th%s><button type=\"button\">%s</button></th>", left ? " class=\"l\"" : "", label);
}

igi_status igi_page_table(const igi_page *page)
{
    FILE *f = page->file;
    const igi_materials *all = page->materials;
    static const char *const rgb[] = {"&rho; red", "green", "blue"};
    bool lobes = false;
    for (size_t i = 0; i < all->count; i++) lobes |= all->materials[i].model != IGI_LAMBERT;
    fputs(
        "<section id=\"materials\"><h2>Materials</h2><p class=\"soft\">&rho; is the diffuse "
        "albedo, the share of "
        "the light of a band that a surface sends back evenly in all directions, from 0 to 1; the "
        "mean over what the photographs determine. 1&thinsp;&sigma; is its standard deviation, "
        "relative, the largest of the bands. Model: lambert is diffuse alone; ward, ggx and phong "
        "have a lobe too, which sends &rho;<sub>s</sub> about the mirror direction, the wider the "
        "larger &alpha;. Observed: the share of the area that a photograph shows; views: how many "
        "photographs do. Click a heading to sort.</p>"
        "<div class=\"card scroll\" tabindex=\"0\"><table><thead><tr><th></th>",
        f);
    print_heading(f, "region", true);
    print_heading(f, "model", true);
    for (int b = 0; b < all->bands; b++) {
        char label[32];
        snprintf(label, sizeof label, b ? "%d" : "&rho; band %d", b + 1);
        print_heading(f, all->bands == 3 ? rgb[b] : label, false);
    }
    print_heading(f, "1&thinsp;&sigma;", false);
    if (lobes) {
        print_heading(f, "specular &rho;<sub>s</sub>", false);
        print_heading(f, "roughness &alpha;", false);
    }
    print_heading(f, "observed", false);
    print_heading(f, "views", false);
    fputs("</tr></thead><tbody>\n", f);
    for (size_t i = 0; i < all->count; i++) {
        if (all->materials[i].emitter) continue;
        print_row(page, &all->materials[i], lobes);
        print_notes(page, &all->materials[i], lobes);
    }
    fputs("</tbody></table></div></section>\n", f);
    return IGI_OK;
}
