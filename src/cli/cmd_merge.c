/* SPDX-License-Identifier: Apache-2.0
 *
 * igi merge: a bracket of exposures to one radiance image.
 */
#include "cli.h"

#include <string.h>

static igi_status usage(const char *sentence)
{
    fprintf(stderr, "igi: merge: %s\n", sentence);
    return IGI_E_USAGE;
}

static igi_status read_exposures(cli_session *s, igi_exposure **exposures, size_t *count)
{
    if (s->values.list) return igi_exposures_read(s->context, s->values.list, exposures, count);
    *count = (size_t)s->argument_count;
    return igi_exposures_probe(s->context, s->arguments, *count, exposures);
}

/* *calibration holds the response that the options point to, if they name a file. */
static igi_status set_options(cli_session *s, igi_merge_options *options,
                              igi_calibration **calibration)
{
    static const char *const kinds[] = {"auto",       "linear", "srgb",    NULL,       "recovered",
                                        "polynomial", "emor",   "debevec", "robertson"};
    const cli_values *v = &s->values;
    igi_merge_options_init(options);
    options->method = strcmp(v->weights, "debevec") == 0     ? IGI_MERGE_DEBEVEC
                      : strcmp(v->weights, "robertson") == 0 ? IGI_MERGE_ROBERTSON
                                                             : IGI_MERGE_PHOTON;
    options->align = !v->no_align;
    options->refine = !v->no_refine;
    options->full_well_e = v->full_well;
    options->read_noise = v->read_noise;
    options->basis_path = v->basis;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (kinds[i] && strcmp(v->response, kinds[i]) == 0) {
            options->response = (igi_response_kind)i;
            return IGI_OK;
        }
    igi_status status = igi_calibration_load(s->context, v->response, calibration);
    if (status != IGI_OK) return status;
    if (!(*calibration)->response) {
        fprintf(stderr, "igi: %s: has no response; merge with --save-response first\n",
                v->response);
        return IGI_E_DATA;
    }
    options->response = IGI_RESPONSE_GIVEN;
    options->given = (*calibration)->response;
    return IGI_OK;
}

static igi_status save_response(cli_session *s, igi_merged *merged)
{
    const char *path = s->values.save_response;
    igi_calibration *calibration = NULL;
    igi_status status = IGI_OK;
    FILE *file = fopen(path, "r");
    if (file) {
        fclose(file);
        status = igi_calibration_load(s->context, path, &calibration);
    } else {
        status = igi_calibration_create(s->context, merged->image->width, merged->image->height,
                                        &calibration);
    }
    if (status == IGI_OK) {
        igi_response_destroy(calibration->response);
        calibration->response = merged->response;
        merged->response = NULL;
        status = igi_calibration_save(s->context, calibration, path);
    }
    igi_calibration_destroy(calibration);
    return status;
}

static void print_json(const cli_session *s, const igi_exposure *exposures,
                       const igi_merged *merged)
{
    printf("{\"output\": ");
    cli_print_json_string(s->values.output);
    printf(", \"width\": %d, \"height\": %d, \"scatter\": ", merged->image->width,
           merged->image->height);
    cli_print_json_number(merged->scatter);
    printf(",\n \"exposures\": [");
    for (size_t i = 0; i < merged->count; i++) {
        const igi_merged_frame *f = &merged->frames[i];
        printf("%s\n  {\"file\": ", i ? "," : "");
        cli_print_json_string(exposures[i].path);
        printf(", \"stated\": ");
        cli_print_json_number(f->stated);
        printf(", \"used\": ");
        cli_print_json_number(f->used);
        printf(", \"shift\": [%.4g, %.4g], \"rotation_deg\": %.4g, \"saturated\": ", f->shift_x,
               f->shift_y, f->rotation_deg);
        cli_print_json_number(f->saturated);
        printf(", \"moved\": ");
        cli_print_json_number(f->moved);
        printf("}");
    }
    puts("]}");
}

static void print_table(const cli_session *s, const igi_exposure *exposures,
                        const igi_merged *merged)
{
    int width = 5;
    for (size_t i = 0; i < merged->count; i++) {
        int w = cli_text_width(cli_file_name(exposures[i].path));
        if (w > width) width = w;
    }
    cli_print_padded("image", width);
    puts("    exposure  used/stated        shift px  saturated      moved");
    for (size_t i = 0; i < merged->count; i++) {
        const igi_merged_frame *f = &merged->frames[i];
        cli_print_padded(cli_file_name(exposures[i].path), width);
        printf("  %10.6g  %11.4f  %6.2f, %6.2f  ", f->stated, f->used / f->stated, f->shift_x,
               f->shift_y);
        cli_print_percent(f->saturated, 9);
        fputs("  ", stdout);
        cli_print_percent(f->moved, 9);
        puts("");
    }
    printf("%s: %d x %d pixels\n", s->values.output, merged->image->width, merged->image->height);
}

static bool is_exr(const char *path)
{
    size_t length = strlen(path);
    return length > 4 &&
           (strcmp(path + length - 4, ".exr") == 0 || strcmp(path + length - 4, ".EXR") == 0);
}

static igi_status run(cli_session *s)
{
    igi_exposure *exposures = NULL;
    size_t count = 0;
    igi_merge_options options;
    igi_calibration *calibration = NULL;
    igi_merged *merged = NULL;
    if (!s->values.output) return usage("where to? give an OpenEXR file with -o");
    if (!is_exr(s->values.output))
        return usage("radiance is written as OpenEXR; give -o a name that ends in .exr");
    if (!s->values.list == !s->argument_count)
        return usage("name the images, or a --list of them; not both");
    igi_status status = set_options(s, &options, &calibration);
    if (status == IGI_OK) status = read_exposures(s, &exposures, &count);
    if (status == IGI_OK) status = igi_merge(s->context, exposures, count, &options, &merged);
    if (status == IGI_OK)
        status = igi_image_save_exr(s->context, merged->image, IGI_EXR_FLOAT, s->values.output);
    if (status == IGI_OK && s->values.save_response) status = save_response(s, merged);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && merged->warning) cli_progress_log(s, merged->warning);
    if (status == IGI_OK && s->values.json) print_json(s, exposures, merged);
    else if (status == IGI_OK && !s->values.quiet) print_table(s, exposures, merged);
    igi_merged_destroy(merged);
    igi_exposures_destroy(exposures, count);
    igi_calibration_destroy(calibration);
    return status;
}

const cli_command cli_merge = {
    .name = "merge",
    .bit = CLI_MERGE,
    .more = true,
    .usage = "merge IMAGE... -o OUT.exr",
    .summary = "a bracket of exposures to one radiance image",
    .example = "igi merge desk-*.jpg -o desk.exr",
    .details =
        "JPEG, PNG, TIFF or raw photographs of one place at several exposures. OUT.exr receives\n"
        "radiance (R G B; full scale over exposure, so that all brackets of a camera share one\n"
        "unit), \"saturated\" (1 where even the shortest exposure was, .5 where something moved\n"
        "between exposures; igi recover leaves both out), and \"variance.R\" ...\n"
        "Shifts and turns between the photographs are found and undone; what lies still is not\n"
        "resampled. Exposures that the pictures contradict are refused by name.",
    .run = run,
};
