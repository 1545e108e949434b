/* SPDX-License-Identifier: Apache-2.0
 *
 * igi synth: a scene folder with photographs and truth from a short spec.
 */
#include "cli.h"

static igi_status save_manifest(cli_session *s, const char *folder)
{
    igi_setting settings[24];
    char numbers[24][32], command[4096];
    const char *inputs[] = {s->arguments[0]};
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command,
                             .setting_count = cli_settings(s, settings, numbers, 24),
                             .settings = settings,
                             .input_count = 1,
                             .inputs = inputs};
    return igi_manifest_save(s->context, &manifest, folder);
}

static igi_status run(cli_session *s)
{
    const char *spec = s->arguments[0], *folder = s->values.output;
    igi_output *output = NULL;
    if (!folder) {
        fprintf(stderr, "igi: synth: where to? give a folder with -o\n");
        return IGI_E_USAGE;
    }
    if (s->values.basis && !s->values.photos) {
        fprintf(stderr, "igi: synth: --basis is of the camera's response, so of --photos\n");
        return IGI_E_USAGE;
    }
    cli_progress_report(s, "reading the spec", 0);
    igi_status status = igi_output_begin(s->context, folder, s->values.force, spec, &output);
    if (status == IGI_OK)
        status = s->values.photos ? igi_synth_photos(s->context, spec, igi_output_folder(output),
                                                     s->values.basis)
                                  : igi_synth(s->context, spec, igi_output_folder(output));
    if (status == IGI_OK) status = save_manifest(s, igi_output_folder(output));
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    igi_output_destroy(output);
    cli_progress_clear(&s->progress);
    if (status != IGI_OK) return status;
    if (s->values.json) {
        fputs("{\"scene\": ", stdout);
        cli_print_json_string(folder);
        puts("}");
    } else if (!s->values.quiet && s->values.photos) {
        printf("%s: written; merge and correct photos/ into images/ (igi help merge)\n", folder);
    } else if (!s->values.quiet) {
        printf("%s: written; try igi recover %s -o %s.out\n", folder, folder, folder);
    }
    return IGI_OK;
}

const cli_command cli_synth = {
    .name = "synth",
    .bit = CLI_SYNTH,
    .arguments = 1,
    .usage = "synth SPEC -o SCENE",
    .summary = "a room with photographs and known truth from a spec",
    .example = "igi synth datasets-synthetic/demo-room.json -o demo-room",
    .details =
        "SPEC is a JSON file (datasets-synthetic/README.md). SCENE receives scene.json, mesh,\n"
        "cameras, images/ and truth/, and heldout/ and relit/ where SPEC asks for them. The\n"
        "same SPEC and --seed give the same bytes.",
    .run = run,
};
