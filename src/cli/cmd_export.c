/* SPDX-License-Identifier: Apache-2.0
 *
 * igi export: a recovered scene for other programs.
 */
#include "cli.h"

static igi_status run(cli_session *s)
{
    const cli_values *values = &s->values;
    igi_export_options options;
    char command[4096];
    if (!values->output || !values->to) {
        fprintf(stderr, values->output
                            ? "igi: export: for whom? --to glb, obj, mitsuba, pbrt or radiance\n"
                            : "igi: export: where to? give a file with -o\n");
        return IGI_E_USAGE;
    }
    igi_export_options_init(&options);
    bool known = igi_export_format_from_name(values->to, &options.format);
    (void)known; /* the table of options lets no other name through */
    options.lights = values->lights;
    options.cameras = values->cameras;
    cli_command_line(s, command, sizeof command);
    options.command = command;
    igi_status status = igi_export(s->context, s->arguments[0], &options, values->output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && cli_begin_written(s, values->output)) puts("}");
    else if (status == IGI_OK && !values->quiet) printf("%s: written\n", values->output);
    return status;
}

const cli_command cli_export = {
    .name = "export",
    .bit = CLI_EXPORT,
    .arguments = 1,
    .usage = "export OUT --to FORMAT -o FILE",
    .summary = "a recovered scene for Blender, Mitsuba, pbrt, Radiance",
    .example = "igi export room.out --to mitsuba -o room.xml",
    .details =
        "OUT is what `igi recover` wrote, or a scene's truth folder. All formats but glb also\n"
        "write a folder beside FILE for meshes and textures: room.xml_files/.",
    .run = run,
};
