/* SPDX-License-Identifier: Apache-2.0
 *
 * The table of lights.
 */
#include "report/page.h"

#include "material/material.h"

static const char *unit_of(igi_light_type type)
{
    switch (type) {
    case IGI_LIGHT_AREA:
    case IGI_LIGHT_AMBIENT:
        return "radiance, W&thinsp;m<sup>&minus;2</sup>&thinsp;sr<sup>&minus;1</sup>";
    case IGI_LIGHT_POINT:
    case IGI_LIGHT_SPOT: return "intensity, W&thinsp;sr<sup>&minus;1</sup>";
    case IGI_LIGHT_LINE:
        return "intensity, W&thinsp;sr<sup>&minus;1</sup>&thinsp;m<sup>&minus;1</sup>";
    case IGI_LIGHT_DIRECTIONAL: return "irradiance, W&thinsp;m<sup>&minus;2</sup>";
    case IGI_LIGHT_GONIOMETRIC:
    case IGI_LIGHT_ENV: return "scale";
    }
    return "";
}

static bool is_solved(const double *std, int bands)
{
    bool solved = false;
    for (int b = 0; b < bands; b++) solved |= std[b] > 0;
    return solved;
}

static void print_light(const igi_page *page, const igi_light *light, const double *std)
{
    FILE *f = page->file;
    const igi_materials *all = page->materials;
    bool solved = is_solved(std, all->bands);
    fprintf(f, "<tr><td class=\"l\">%s</td><td class=\"l\">", igi_light_type_name(light->type));
    if (light->region >= 0) igi_page_text(page, all->materials[light->region].region);
    if (light->profile > 0) fprintf(f, ", cos<sup>%g</sup>", light->profile);
    fprintf(f, "</td><td class=\"l\">%s</td>", unit_of(light->type));
    for (int b = 0; b < all->bands; b++) {
        if (!light->known) fputs("<td>&ndash;</td>", f);
        else fprintf(f, "<td>%.5g", light->value[b]);
        if (light->known && solved)
            fprintf(f, " <span class=\"soft\">&plusmn;&thinsp;%.2g</span>", std[b]);
        if (light->known) fputs("</td>", f);
    }
    fprintf(f, "<td class=\"l\">%s</td></tr>\n",
            !light->known ? "unknown"
            : solved      ? "from the photographs"
                          : "given");
}

igi_status igi_page_lights(const igi_page *page)
{
    FILE *f = page->file;
    const igi_materials *all = page->materials;
    static const char *const rgb[] = {"red", "green", "blue"};
    fputs("<section id=\"lights\"><h2>Lights</h2><div class=\"card scroll\" "
          "tabindex=\"0\"><table><thead><tr><th "
          "class=\"l\">kind"
          "</th><th class=\"l\">region</th><th class=\"l\">value</th>",
          f);
    for (int b = 0; b < all->bands; b++) {
        if (all->bands == 3) fprintf(f, "<th>%s</th>", rgb[b]);
        else fprintf(f, "<th>band %d</th>", b + 1);
    }
    fputs("<th class=\"l\">known</th></tr></thead><tbody>\n", f);
    for (size_t i = 0; i < all->light_count; i++)
        print_light(page, &all->lights[i], all->light_std[i]);
    fputs("</tbody></table></div></section>\n", f);
    return IGI_OK;
}
