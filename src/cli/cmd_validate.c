/* SPDX-License-Identifier: Apache-2.0
 *
 * igi validate: errors against truth, as a table or as JSON.
 */
#include "cli.h"

#include <math.h>

static void print_field(const char *key, double x, bool *first)
{
    if (!isfinite(x)) return;
    printf("%s\"%s\": ", *first ? "" : ", ", key);
    cli_print_json_number(x);
    *first = false;
}

static void print_numbers(const char *key, const double *values, int count)
{
    printf(", \"%s\": [", key);
    for (int i = 0; i < count; i++) {
        fputs(i ? ", " : "", stdout);
        cli_print_json_number(values[i]);
    }
    putchar(']');
}

static void print_region_json(const igi_region_error *r, int bands)
{
    if (r->missing) {
        fputs("\"missing\"", stdout);
        return;
    }
    bool first = true;
    putchar('{');
    print_field("albedo", r->albedo, &first);
    printf(", \"model\": [\"%s\", \"%s\"]", igi_model_name(r->got), igi_model_name(r->want));
    print_field("specular", r->specular, &first);
    print_field("alpha", r->alpha, &first);
    print_field("texture_median", r->texture_median, &first);
    print_field("texture_mean", r->texture_mean, &first);
    print_field("texture_seen", r->texture_seen, &first);
    print_field("sigmas", r->sigmas, &first);
    print_field("specular_z", r->specular_z, &first);
    print_field("alpha_z", r->alpha_z, &first);
    print_numbers("albedo_z", r->albedo_z, bands);
    print_numbers("specular_values", r->specular_values, 3);
    print_numbers("alpha_values", r->alpha_values, 3);
    printf(", \"coloured\": [%s, %s]", r->coloured ? "true" : "false",
           r->want_coloured ? "true" : "false");
    print_numbers("specular_rgb_z", r->specular_rgb_z, bands);
    putchar('}');
}

static void print_json(const igi_validation *v)
{
    const struct {
        const char *key;
        double x;
    } means[] = {{"albedo_mean", v->albedo_mean}, {"albedo_median", v->albedo_median},
                 {"albedo_max", v->albedo_max},   {"specular_mean", v->specular_mean},
                 {"alpha_mean", v->alpha_mean},   {"texture_median", v->texture_median}};
    putchar('{');
    for (size_t i = 0; i < sizeof means / sizeof means[0]; i++) {
        printf("\"%s\": ", means[i].key);
        cli_print_json_number(means[i].x);
        fputs(", ", stdout);
    }
    printf(
        "\"models_right\": %d, \"models\": %d, \"glossy_tp_fp_fn\": [%d, %d, %d], \"regions\": {",
        v->models_right, v->models, v->glossy_right, v->glossy_false, v->glossy_missed);
    const char *comma = "";
    for (size_t i = 0; i < v->region_count; i++) {
        if (!v->regions[i].judged) continue;
        fputs(comma, stdout);
        cli_print_json_string(v->regions[i].region);
        fputs(": ", stdout);
        print_region_json(&v->regions[i], v->bands);
        comma = ", ";
    }
    puts("}}");
}

/* "0.0605 +- 0.0050 (0.0600)": recovered, one sigma, true. */
static void print_values(const double values[3])
{
    if (isfinite(values[0])) printf("   %6.4f +- %6.4f", values[0], values[1]);
    else printf("   %16s", "none");
    if (isfinite(values[2])) printf(" (%6.4f)", values[2]);
    else printf(" %8s", "(none)");
}

/* Of every region that has a lobe, or should have one. */
static void print_lobes(const igi_validation *v, int width)
{
    bool begun = false;
    for (size_t i = 0; i < v->region_count; i++) {
        const igi_region_error *r = &v->regions[i];
        if (!r->judged || r->missing) continue;
        if (!isfinite(r->specular_values[0]) && !isfinite(r->specular_values[2])) continue;
        if (!begun) {
            puts("");
            cli_print_padded("lobes", width);
            printf("   %-25s   %s\n", "specular +- 1 sigma (true)", "alpha +- 1 sigma (true)");
        }
        begun = true;
        cli_print_padded(r->region, width);
        print_values(r->specular_values);
        print_values(r->alpha_values);
        if (r->coloured != r->want_coloured)
            fputs(r->coloured ? "   coloured (is not)" : "   not coloured (is)", stdout);
        puts("");
    }
}

static void print_row(const igi_region_error *r, int width)
{
    cli_print_padded(r->region, width);
    if (!r->judged || r->missing) {
        puts(r->missing ? "   missing" : "   not judged");
        return;
    }
    cli_print_percent(r->albedo, 11);
    if (isfinite(r->sigmas)) printf("%9.1f", r->sigmas);
    else printf("%9s", "-");
    cli_print_percent(r->texture_median, 11);
    cli_print_percent(r->specular, 11);
    cli_print_percent(r->alpha, 11);
    printf("  %s", igi_model_name(r->got));
    if (r->got != r->want) printf(" (is %s)", igi_model_name(r->want));
    puts("");
}

static void print_table(const igi_validation *v)
{
    int width = 8;
    for (size_t i = 0; i < v->region_count; i++) {
        int w = cli_text_width(v->regions[i].region);
        if (w > width) width = w;
    }
    cli_print_padded("error of", width);
    printf("%11s%9s%11s%11s%11s  %s\n", "albedo", "sigmas", "texels", "specular", "alpha", "model");
    for (size_t i = 0; i < v->region_count; i++) print_row(&v->regions[i], width);
    cli_print_padded("mean", width);
    cli_print_percent(v->albedo_mean, 11);
    printf("%9s", "");
    cli_print_percent(v->texture_median, 11);
    cli_print_percent(v->specular_mean, 11);
    cli_print_percent(v->alpha_mean, 11);
    printf("  %d of %d right\n", v->models_right, v->models);
    cli_print_padded("median", width);
    cli_print_percent(v->albedo_median, 11);
    puts("");
    cli_print_padded("largest", width);
    cli_print_percent(v->albedo_max, 11);
    puts("");
    print_lobes(v, width);
}

/* A result of another scene is compared as well, and says nothing. */
static void warn_of_missing(const cli_session *s, const igi_validation *v)
{
    size_t judged = 0, missing = 0;
    for (size_t i = 0; i < v->region_count; i++) {
        judged += v->regions[i].judged;
        missing += v->regions[i].missing;
    }
    if (missing && !s->values.quiet)
        fprintf(
            stderr,
            "igi: warning: %s: lacks %zu of the %zu regions of %s; is that its scene's truth?\n",
            s->arguments[0], missing, judged, s->values.truth);
}

static igi_status run(cli_session *s)
{
    igi_validation *validation = NULL;
    if (!s->values.truth) {
        fprintf(stderr, "igi: validate: against what? give the truth folder with --truth\n");
        return IGI_E_USAGE;
    }
    cli_progress_report(s, "comparing", 0);
    igi_status status = igi_validate(s->context, s->arguments[0], s->values.truth, &validation);
    cli_progress_clear(&s->progress);
    if (status != IGI_OK) return status;
    warn_of_missing(s, validation);
    if (s->values.json) print_json(validation);
    else if (!s->values.quiet) print_table(validation);
    double tolerance = s->values.tolerance;
    bool over = tolerance > 0 && !(validation->albedo_mean <= tolerance);
    if (over)
        fprintf(stderr, "igi: %s: the mean albedo error %.3g is above the tolerance %.3g\n",
                s->arguments[0], validation->albedo_mean, tolerance);
    igi_validation_destroy(validation);
    return over ? IGI_E_NO_ANSWER : IGI_OK;
}

const cli_command cli_validate = {
    .name = "validate",
    .bit = CLI_VALIDATE,
    .arguments = 1,
    .usage = "validate OUT --truth SCENE/truth",
    .summary = "errors of a result against truth",
    .example = "igi validate cornell.out --truth cornell/truth",
    .details =
        "Errors are relative, |got - true| / max(true, 0.02), the mean over bands; of a map,\n"
        "over the texels that the photographs determine. sigmas: the largest error of a band\n"
        "in units of its stated standard deviation; --json has them signed, band by band, and\n"
        "those of specular and alpha. Emitters, and regions of which less than a fifth is\n"
        "seen, are not judged. Lobes stand below with what they should be.",
    .run = run,
};
