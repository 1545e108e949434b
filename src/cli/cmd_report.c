/* SPDX-License-Identifier: Apache-2.0
 *
 * igi report: the page of a result, anew.
 */
#include "cli.h"

static igi_status run(cli_session *s)
{
    const char *folder = s->arguments[0];
    igi_status status = IGI_OK;
    if (!s->values.relight && (s->values.cameras || s->values.samples > 0)) {
        fprintf(stderr, "igi: report: --cameras and --samples are of the pictures of --relight\n");
        return IGI_E_USAGE;
    }
    if (s->values.relight) {
        igi_basis_options options;
        igi_basis_options_init(&options);
        if (s->values.samples > 0) options.render.samples = (int)s->values.samples;
        status = igi_basis_save(s->context, folder, s->values.cameras, &options);
    }
    cli_progress_report(s, "writing the page", 0);
    if (status == IGI_OK) status = igi_report(s->context, folder, s->values.truth);
    cli_progress_clear(&s->progress);
    if (status != IGI_OK) return status;
    if (s->values.json) {
        fputs("{\"report\": ", stdout);
        char path[4096];
        snprintf(path, sizeof path, "%s/report.html", folder);
        cli_print_json_string(path);
        puts("}");
    } else if (!s->values.quiet) {
        printf("%s/report.html: written\n", folder);
    }
    return IGI_OK;
}

const cli_command cli_report = {
    .name = "report",
    .bit = CLI_REPORT,
    .arguments = 1,
    .usage = "report OUT [--truth SCENE/truth]",
    .summary = "one page to look at: OUT/report.html",
    .example = "igi report my-room.out",
    .details =
        "OUT is what igi recover wrote; it has a report already. This makes it anew, from\n"
        "materials.json, manifest.json, the maps and the comparisons. With --relight it also\n"
        "renders a picture for each lamp, which sliders on the page weigh and colour.",
    .run = run,
};
