/* SPDX-License-Identifier: Apache-2.0
 *
 * igi synth: a photo set with known reflectance from a short spec.
 */
#include "cli.h"

static igi_status save_manifest(cli_session *s, const char *folder)
{
    char command[4096], text[CLI_MAX_ARGUMENTS * 2][32];
    igi_setting settings[CLI_MAX_ARGUMENTS * 2];
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command, .settings = settings, .input_count = 1,
                             .inputs = &s->arguments[0]};
    manifest.setting_count = cli_settings(s, settings, text, CLI_MAX_ARGUMENTS * 2);
    return igi_manifest_save(s->context, &manifest, folder);
}

static igi_status run(cli_session *s)
{
    const char *spec = s->arguments[0];
    igi_output *output = NULL;
    if (!s->values.output) {
        fprintf(stderr, "igi: synth: where to? give a folder with -o\n");
        return IGI_E_USAGE;
    }
    igi_status status = igi_output_begin(s->context, s->values.output, s->values.force, spec, &output);
    if (status == IGI_OK) status = igi_synth(s->context, spec, igi_output_folder(output));
    if (status == IGI_OK) status = save_manifest(s, igi_output_folder(output));
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && !s->values.quiet) printf("%s: written\n", s->values.output);
    igi_output_destroy(output);
    return status;
}

const cli_command cli_synth = {
    .name = "synth",
    .bit = CLI_SYNTH,
    .arguments = 1,
    .usage = "synth SPEC -o SCENE",
    .summary = "a photo set with known reflectance from a short spec",
    .example = "igi synth datasets-synthetic/demo-room.json -o demo-room",
    .details = "SPEC is a JSON file (datasets-synthetic/README.md). SCENE receives scene.json, mesh,\n"
               "cameras and images, truth/, and heldout/ and relit/ where SPEC asks for them. The\n"
               "same SPEC and --seed give the same bytes.",
    .run = run,
};
