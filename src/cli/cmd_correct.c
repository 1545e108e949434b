/* SPDX-License-Identifier: Apache-2.0
 *
 * igi correct: radiance images without distortion and vignetting.
 */
#include "cli.h"

#include <string.h>

static igi_status usage(const char *sentence)
{
    fprintf(stderr, "igi: correct: %s\n", sentence);
    return IGI_E_USAGE;
}

static bool names_differ(const cli_session *s)
{
    for (int i = 0; i < s->argument_count; i++)
        for (int j = 0; j < i; j++)
            if (strcmp(cli_file_name(s->arguments[i]), cli_file_name(s->arguments[j])) == 0) {
                fprintf(stderr, "igi: %s and %s would be written to one file; correct them apart\n",
                        s->arguments[j], s->arguments[i]);
                return false;
            }
    return true;
}

static igi_status correct(cli_session *s, const igi_calibration *calibration, const char *from,
                          const char *folder)
{
    char path[4096];
    igi_image *image = NULL, *corrected = NULL;
    igi_status status = igi_image_load_photograph(s->context, from, &image);
    if (status == IGI_OK &&
        (image->width != calibration->width || image->height != calibration->height)) {
        fprintf(stderr,
                "igi: %s: %d x %d pixels, and the calibration is for %d x %d; use the full "
                "size, uncropped\n",
                from, image->width, image->height, calibration->width, calibration->height);
        status = IGI_E_DATA;
    }
    if (status == IGI_OK) status = igi_correct(s->context, calibration, image, &corrected, NULL);
    snprintf(path, sizeof path, "%s/%s", folder, cli_file_name(from));
    if (status == IGI_OK) status = igi_image_save_exr(s->context, corrected, IGI_EXR_FLOAT, path);
    igi_image_destroy(corrected);
    igi_image_destroy(image);
    return status;
}

/* The camera that the corrected images show: the same without what was undone. */
static igi_status save_pinhole(cli_session *s, igi_calibration *calibration, const char *folder)
{
    char path[4096];
    igi_camera *lens = &calibration->lens;
    lens->k1 = lens->k2 = lens->k3 = lens->p1 = lens->p2 = 0;
    calibration->vignetting.known = false;
    igi_response_destroy(calibration->response);
    calibration->response = NULL;
    snprintf(path, sizeof path, "%s/camera.json", folder);
    return igi_calibration_save(s->context, calibration, path);
}

static igi_status save_manifest(cli_session *s, const char *folder)
{
    igi_setting settings[24];
    char numbers[24][32], command[4096];
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command,
                             .setting_count = cli_settings(s, settings, numbers, 24),
                             .settings = settings,
                             .input_count = (size_t)s->argument_count,
                             .inputs = s->arguments};
    return igi_manifest_save(s->context, &manifest, folder);
}

static igi_status run(cli_session *s)
{
    igi_calibration *calibration = NULL;
    igi_output *output = NULL;
    if (!s->values.output) return usage("where to? give a folder with -o");
    if (!s->values.calibration)
        return usage("by what? give what igi calibrate wrote with --calibration");
    if (!names_differ(s)) return IGI_E_USAGE;
    igi_status status = igi_calibration_load(s->context, s->values.calibration, &calibration);
    if (status == IGI_OK)
        status = igi_output_begin(s->context, s->values.output, s->values.force, s->arguments[0],
                                  &output);
    for (int i = 0; status == IGI_OK && i < s->argument_count; i++)
        status = correct(s, calibration, s->arguments[i], igi_output_folder(output));
    if (status == IGI_OK) status = save_pinhole(s, calibration, igi_output_folder(output));
    if (status == IGI_OK) status = save_manifest(s, igi_output_folder(output));
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && cli_begin_written(s, s->values.output)) {
        cli_print_json_field("images", s->argument_count);
        puts("}");
    } else if (status == IGI_OK && !s->values.quiet)
        printf("%s: %d image%s corrected\n", s->values.output, s->argument_count,
               s->argument_count == 1 ? "" : "s");
    igi_output_destroy(output);
    igi_calibration_destroy(calibration);
    return status;
}

const cli_command cli_correct = {
    .name = "correct",
    .bit = CLI_CORRECT,
    .arguments = 1,
    .more = true,
    .usage = "correct IMAGE... -o FOLDER",
    .summary = "radiance images without distortion and vignetting",
    .example = "igi correct --calibration calib/lens.json images/*.exr -o corrected",
    .details =
        "FOLDER receives the images under their names, resampled once, variances carried along,\n"
        "and camera.json: the pinhole that they now show.",
    .run = run,
};
