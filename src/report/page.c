/* SPDX-License-Identifier: Apache-2.0
 *
 * report.html: one page that needs nothing but itself. Pictures are inside, nothing is fetched.
 */
#include "report/page.h"

#include "base/order.h"

#include <igi/output.h>
#include <igi/report.h>

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* The middle one of the determined regions' relative sigmas; NaN when there is none. */
static double typical_share(const igi_page *page, size_t *determined, size_t *surfaces)
{
    double shares[512];
    size_t count = 0;
    *determined = *surfaces = 0;
    for (size_t i = 0; i < page->materials->count; i++) {
        const igi_material *m = &page->materials->materials[i];
        *surfaces += !m->emitter;
        *determined += m->determined;
        if (m->determined && count < 512)
            shares[count++] = igi_material_share(m, page->materials->bands);
    }
    return igi_median(shares, count);
}

static void print_tiles(const igi_page *page)
{
    FILE *f = page->file;
    const json_t *stages = json_object_get(page->manifest, "stages");
    size_t determined, surfaces;
    double share = typical_share(page, &determined, &surfaces), cpu = 0, rays = 0, memory = 0;
    fprintf(f,
            "<dl class=\"tiles\"><div><dt>regions determined</dt><dd>%zu of %zu</dd></div>"
            "<div><dt>typical 1&thinsp;&sigma; of albedo</dt><dd>",
            determined, surfaces);
    igi_page_percent(page, share);
    fputs("</dd></div>", f);
    for (size_t i = 0; i < json_array_size(stages); i++) {
        const json_t *s = json_array_get(stages, i);
        cpu += json_number_value(json_object_get(s, "cpu_s"));
        rays += json_number_value(json_object_get(s, "rays"));
        memory = fmax(memory, json_number_value(json_object_get(s, "peak_bytes")));
    }
    if (json_array_size(stages) > 0)
        fprintf(f,
                "<div><dt>CPU time</dt><dd>%.2f s</dd></div><div><dt>rays</dt><dd>%.1f million</dd>"
                "</div><div><dt>peak memory</dt><dd>%.0f MB</dd></div>",
                cpu, rays * 1e-6, memory * 1e-6);
    fputs("</dl>\n", f);
}

/* Those of the whole, and how many regions have one of their own. */
static void print_warnings(const igi_page *page)
{
    FILE *f = page->file;
    const igi_materials *all = page->materials;
    size_t noted = 0;
    for (size_t i = 0; i < all->count; i++) noted += all->materials[i].warning_count > 0;
    if (all->warning_count == 0 && noted == 0) return;
    fputs("<div class=\"warnings\"><b>Warnings</b><ul>", f);
    for (size_t i = 0; i < all->warning_count; i++) {
        fputs("<li>", f);
        igi_page_text(page, all->warnings[i]);
        fputs("</li>", f);
    }
    if (noted)
        fprintf(
            f, "<li>%zu region%s a warning of %s own, in <a href=\"#materials\">the table</a></li>",
            noted, noted == 1 ? " has" : "s have", noted == 1 ? "its" : "their");
    fputs("</ul></div>\n", f);
}

static igi_status print_head(const igi_page *page)
{
    igi_page_begin(page, page->materials->scene[0] ? page->materials->scene : "a scene",
                   "What its surfaces are made of, recovered from photographs, and how far they "
                   "can be trusted.");
    print_warnings(page);
    fputs("<div class=\"first\">", page->file);
    IGI_TRY(igi_page_first_view(page));
    print_tiles(page);
    fputs("</div>\n", page->file);
    return IGI_OK;
}

static igi_status print_meaning(const igi_page *page)
{
    fputs(
        "<section id=\"meaning\"><h2>What the error bars mean</h2><p>An albedo is the light that "
        "leaves a surface "
        "over the light that arrives, &rho; = &pi;&thinsp;L / E. One standard deviation "
        "(1&thinsp;&sigma;) holds the photographs' noise, the sampling of the arriving light, and "
        "the doubt about lights and surfaces that had to be solved for. If these were all the "
        "errors there are, two of three true values would lie within it, and nineteen of twenty "
        "within twice it.</p><p>It does not hold what the model cannot know: wrong geometry or "
        "cameras, a lamp missing from the list, a camera whose response was not undone. An error "
        "of scale common to all photographs and lights moves albedos by about (1 &minus; &rho;) "
        "of itself.</p></section>\n",
        page->file);
    return IGI_OK;
}

static bool has_always(const igi_page *page)
{
    return page != NULL;
}

static bool has_evidence(const igi_page *page)
{
    return json_object_size(json_object_get(page->evidence, "regions")) > 0;
}

static bool has_lights(const igi_page *page)
{
    return page->materials->light_count > 0;
}

static bool has_maps(const igi_page *page)
{
    for (size_t i = 0; i < page->materials->count; i++)
        if (igi_page_has_map(&page->materials->materials[i])) return true;
    return false;
}

static bool has_views(const igi_page *page)
{
    return json_array_size(json_object_get(page->comparisons, "views")) > 0;
}

static bool has_relight(const igi_page *page)
{
    return json_array_size(json_object_get(page->relight, "lights")) > 0 &&
           json_array_size(json_object_get(page->relight, "views")) > 0;
}

static bool has_costs(const igi_page *page)
{
    return json_array_size(json_object_get(page->manifest, "stages")) > 0;
}

static bool has_manifest(const igi_page *page)
{
    return page->manifest != NULL;
}

static const struct section {
    const char *id, *title;
    bool (*has)(const igi_page *);
    igi_status (*print)(const igi_page *);
} sections[] = {{"materials", "Materials", has_always, igi_page_table},
                {"balls", "Balls", has_always, igi_page_spheres},
                {"evidence", "Evidence", has_evidence, igi_page_evidence},
                {"lights", "Lights", has_lights, igi_page_lights},
                {"maps", "Maps", has_maps, igi_page_maps},
                {"views", "Photograph against prediction", has_views, igi_page_views},
                {"relight", "Relight by hand", has_relight, igi_page_relight},
                {"meaning", "What the error bars mean", has_always, print_meaning},
                {"cost", "Cost", has_costs, igi_page_costs},
                {"provenance", "Provenance", has_manifest, igi_page_provenance}};

enum { SECTION_COUNT = sizeof sections / sizeof sections[0] };

static igi_status print_page(const igi_page *page, const void *unused)
{
    (void)unused;
    IGI_TRY(print_head(page));
    fputs("<nav aria-label=\"sections\">", page->file);
    for (size_t i = 0; i < SECTION_COUNT; i++)
        if (sections[i].has(page))
            fprintf(page->file, "<a href=\"#%s\">%s</a> ", sections[i].id, sections[i].title);
    fputs("</nav>\n", page->file);
    for (size_t i = 0; i < SECTION_COUNT; i++)
        if (sections[i].has(page)) IGI_TRY(sections[i].print(page));
    igi_page_end(page);
    return IGI_OK;
}

/* A JSON file of the result; *root is NULL when there is none. */
static igi_status read_json(const igi_page *page, const char *name, json_t **root)
{
    igi_status status = IGI_OK;
    json_error_t error;
    char *path = NULL;
    IGI_TRY(igi_strprintf(page->ctx, &path, "%s/%s", page->folder, name));
    if (access(path, F_OK) == 0 && !(*root = json_load_file(path, 0, &error)))
        status = igi_fail(page->ctx, IGI_E_DATA, "%s:%d: %s", path, error.line, error.text);
    igi_free(path);
    return status;
}

igi_status igi_report(igi_context *ctx, const char *folder, const char *truth_folder)
{
    igi_status status = IGI_OK;
    igi_materials *materials = NULL, *truth = NULL;
    char *path = NULL;
    igi_page page = {.ctx = ctx, .folder = folder};
    IGI_TRY_GOTO(igi_materials_load(ctx, folder, &materials));
    page.materials = materials;
    if (truth_folder) IGI_TRY_GOTO(igi_materials_load(ctx, truth_folder, &truth));
    if (truth && truth->bands != materials->bands)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "%s: has %d bands, the result %d", truth_folder,
                              truth->bands, materials->bands));
    page.truth = truth;
    IGI_TRY_GOTO(read_json(&page, "manifest.json", &page.manifest));
    IGI_TRY_GOTO(read_json(&page, "evidence.json", &page.evidence));
    IGI_TRY_GOTO(read_json(&page, "comparison/index.json", &page.comparisons));
    IGI_TRY_GOTO(read_json(&page, "relight/index.json", &page.relight));
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/report.html", folder));
    IGI_TRY_GOTO(igi_page_write(&page, path, print_page, NULL));
cleanup:
    json_decref(page.manifest);
    json_decref(page.comparisons);
    json_decref(page.relight);
    json_decref(page.evidence);
    igi_materials_destroy(materials);
    igi_materials_destroy(truth);
    igi_free(path);
    return status;
}
