/* SPDX-License-Identifier: Apache-2.0
 *
 * What the result cost, and where it comes from.
 */
#include "report/page.h"

#include <math.h>

static double number(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key)); /* 0 when there is none */
}

static const char *text(const json_t *object, const char *key)
{
    const char *value = json_string_value(json_object_get(object, key));
    return value ? value : "";
}

igi_status igi_page_costs(const igi_page *page)
{
    FILE *f = page->file;
    const json_t *stages = json_object_get(page->manifest, "stages");
    size_t count = json_array_size(stages);
    double longest = 1e-9, total[3] = {0, 0, 0};
    for (size_t i = 0; i < count; i++)
        longest = fmax(longest, number(json_array_get(stages, i), "cpu_s"));
    fputs("<section id=\"cost\"><h2>Cost</h2><p class=\"soft\">CPU seconds are those of all "
          "threads together; "
          "memory is the peak of the process up to the end of the stage.</p><div class=\"card "
          "scroll\" tabindex=\"0\"><table><thead><tr><th class=\"l\">stage</th><th></th><th>CPU "
          "s</th><th>wall "
          "s</th><th>rays, millions</th><th>memory, MB</th></tr></thead><tbody>\n",
          f);
    for (size_t i = 0; i < count; i++) {
        const json_t *s = json_array_get(stages, i);
        double cpu = number(s, "cpu_s"), wall = number(s, "wall_s"), rays = number(s, "rays");
        total[0] += cpu;
        total[1] += wall;
        total[2] += rays;
        fputs("<tr><td class=\"l\">", f);
        igi_page_text(page, text(s, "name"));
        fprintf(f,
                "</td><td class=\"l\" style=\"width:35%%\"><span class=\"cost\" "
                "style=\"width:%.1f%%\"></span></td><td>%.3f</td><td>%.3f</td><td>%.2f</td>"
                "<td>%.0f</td></tr>\n",
                100 * cpu / longest, cpu, wall, rays * 1e-6, number(s, "peak_bytes") * 1e-6);
    }
    fprintf(f,
            "<tr><td class=\"l\"><b>all</b></td><td></td><td><b>%.3f</b></td><td><b>%.3f</b></td>"
            "<td><b>%.2f</b></td><td></td></tr></tbody></table></div></section>\n",
            total[0], total[1], total[2] * 1e-6);
    return IGI_OK;
}

static void print_options(const igi_page *page)
{
    json_t *options = json_object_get(page->manifest, "options");
    const char *comma = "";
    for (void *it = json_object_iter(options); it; it = json_object_iter_next(options, it)) {
        const char *value = json_string_value(json_object_iter_value(it));
        fputs(comma, page->file);
        igi_page_text(page, json_object_iter_key(it));
        fputs("&nbsp;", page->file);
        igi_page_text(page, value ? value : "");
        comma = ", ";
    }
}

static void print_inputs(const igi_page *page)
{
    FILE *f = page->file;
    const json_t *inputs = json_object_get(page->manifest, "inputs");
    size_t count = json_array_size(inputs);
    fprintf(
        f,
        "<details><summary>%zu input files with their hashes (XXH64)</summary><div class=\"card "
        "scroll\" tabindex=\"0\"><table><thead><tr><th "
        "class=\"l\">file</th><th>bytes</th><th>xxh64</th></tr>"
        "</thead><tbody>\n",
        count);
    for (size_t i = 0; i < count; i++) {
        const json_t *input = json_array_get(inputs, i);
        fputs("<tr><td class=\"l\">", f);
        igi_page_text(page, text(input, "file"));
        fprintf(f, "</td><td>%.0f</td><td><code>", number(input, "bytes"));
        igi_page_text(page, text(input, "xxh64"));
        fputs("</code></td></tr>\n", f);
    }
    fputs("</tbody></table></div></details>\n", f);
}

igi_status igi_page_provenance(const igi_page *page)
{
    FILE *f = page->file;
    fputs("<section id=\"provenance\"><h2>Provenance</h2><dl "
          "class=\"facts\"><dt>program</dt><dd>igi ",
          f);
    igi_page_text(page, text(page->manifest, "version"));
    fputs("</dd><dt>written</dt><dd>", f);
    igi_page_text(page, text(page->manifest, "written"));
    fputs("</dd><dt>command</dt><dd><code>", f);
    igi_page_text(page, text(page->manifest, "command"));
    fputs("</code></dd><dt>options</dt><dd>", f);
    print_options(page);
    fprintf(f, "</dd><dt>threads, seed</dt><dd>%.0f, %.0f</dd></dl>\n",
            number(page->manifest, "threads"), number(page->manifest, "seed"));
    print_inputs(page);
    fputs("</section>\n", f);
    return IGI_OK;
}
