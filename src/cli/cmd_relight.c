/* SPDX-License-Identifier: Apache-2.0
 *
 * igi relight: pictures of a recovered scene under other lights.
 */
#include "cli.h"

#define PREVIEW_SAMPLES 8

static igi_status save_manifest(cli_session *s, const char *folder, double noise)
{
    char command[4096], text[24][32];
    igi_setting settings[24];
    const char *given[] = {s->values.cameras, s->values.lights, s->values.insert, s->values.edits,
                           s->values.sensors};
    const char *inputs[5];
    size_t input_count = 0;
    for (size_t i = 0; i < 5; i++)
        if (given[i]) inputs[input_count++] = given[i];
    cli_command_line(s, command, sizeof command);
    size_t count = cli_settings(s, settings, text, 23);
    snprintf(text[count], sizeof text[count], "%.4g", noise);
    settings[count] = (igi_setting){"noise reached", text[count]};
    igi_manifest manifest = {.command = command,
                             .setting_count = count + 1,
                             .settings = settings,
                             .input_count = input_count,
                             .inputs = inputs};
    return igi_manifest_save(s->context, &manifest, folder);
}

/* Noise is that of a pixel, relative; `doubt` what materials and lights leave, with --sigma. */
static void print_result(const cli_session *s, double noise, const double doubt[2])
{
    const cli_values *values = &s->values;
    if (cli_begin_written(s, values->output)) {
        if (values->cameras) cli_print_json_field("noise", noise);
        if (values->sigma) cli_print_json_field("pixel", doubt[0]);
        if (values->sigma) cli_print_json_field("picture", doubt[1]);
        puts("}");
        return;
    }
    if (values->quiet) return;
    printf("%s: written", values->output);
    if (values->cameras) printf("; noise of a pixel %.3g %% of the mean", 100 * noise);
    puts("");
    if (values->sigma)
        printf("uncertain by %.3g %% a pixel, %.3g %% a picture as a whole (1 sigma, at most)\n",
               100 * doubt[0], 100 * doubt[1]);
}

static igi_status run(cli_session *s)
{
    const cli_values *values = &s->values;
    igi_output *output = NULL;
    igi_relight_options options;
    double noise = 0, doubt[2] = {0, 0};
    if (!values->output || !(values->cameras || values->sensors)) {
        fprintf(stderr, values->output
                            ? "igi: relight: which views? give a file with --cameras (or "
                              "--sensors)\n"
                            : "igi: relight: where to? give a folder with -o\n");
        return IGI_E_USAGE;
    }
    igi_relight_options_init(&options);
    if (values->preview) options.render.samples = PREVIEW_SAMPLES;
    if (values->samples > 0) options.render.samples = (int)values->samples;
    options.preview = values->preview;
    bool known = igi_render_method_from_name(values->forward, &options.method);
    (void)known; /* the table of options lets no other name through */
    if (values->preview && options.method != IGI_RENDER_PATH) {
        fprintf(stderr, "igi: relight: --preview is a method of its own; leave --method out\n");
        return IGI_E_USAGE;
    }
    options.lights = values->lights;
    options.insert = values->insert;
    options.edits = values->edits;
    options.sensors = values->sensors;
    options.target_error = values->target_error;
    options.variance = values->variance;
    options.layers = values->aov;
    options.png = values->png;
    options.noise = &noise;
    options.sigma = values->sigma;
    options.doubt = doubt;
    const char *folder = s->arguments[0];
    igi_status status = igi_output_begin(s->context, values->output, values->force, folder,
                                         &output);
    if (status == IGI_OK)
        status = igi_relight(s->context, folder, values->cameras, &options,
                             igi_output_folder(output));
    if (status == IGI_OK) status = save_manifest(s, igi_output_folder(output), noise);
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK) print_result(s, noise, doubt);
    igi_output_destroy(output);
    return status;
}

const cli_command cli_relight = {
    .name = "relight",
    .bit = CLI_RELIGHT,
    .arguments = 1,
    .usage = "relight OUT --cameras T.json -o DIR",
    .summary = "pictures of a recovered scene under other lights",
    .example =
        "igi relight room.out --lights evening.json --cameras room/transforms.json -o evening",
    .details =
        "OUT is what `igi recover` wrote, or a scene's truth folder. DIR receives an EXR for\n"
        "each frame of T.json, named as its image. An emitter that L.json leaves out is dark.\n"
        "With --target-error, --samples is the size of a pass: passes follow until the mean\n"
        "standard deviation of a pixel is that share of the mean pixel. With --sensors, DIR "
        "receives\n"
        "illuminance.csv: lux and W m^-2 at the points that the file lists, a line each: X Y Z "
        "and\n"
        "the way that the sensor faces. --cameras may then be left out. With --sigma,\n"
        "NAME.sigma.exr is one standard deviation of each pixel, from those of the materials\n"
        "and of solved lights, errors of one region being alike across the picture; sigma.json\n"
        "has \"pixel\" (mean over pixels) and \"picture\" (of their mean), relative.",
    .run = run,
};
