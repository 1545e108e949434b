/* SPDX-License-Identifier: Apache-2.0
 *
 * igi chart: speed against accuracy, errors against parameters, stability where assumptions fail.
 */
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_NAMES = 256 };

/* Cuts a copy of a list "a,b,c" into names; how many, or -1 when they are too many. */
static int cut_list(char *list, const char *names[MAX_NAMES], int count)
{
    for (char *at = list ? strtok(list, ",") : NULL; at; at = strtok(NULL, ",")) {
        if (count == MAX_NAMES) return -1;
        names[count++] = at;
    }
    return count;
}

static void print_errors(const igi_sweep_point *p)
{
    printf("  %9.6g", p->severity);
    cli_print_percent(p->albedo, 10);
    cli_print_percent(p->albedo_max, 10);
    cli_print_percent(p->specular, 10);
    cli_print_percent(p->alpha, 10);
    cli_print_percent(p->relit, 10);
    cli_print_percent(p->covered, 10);
    printf("  %2zu/%zu  %2zu  %2zu\n", p->flagged, p->cases, p->refused, p->silent);
}

static void print_sweep(const igi_sweep_result *s)
{
    printf("\n%s: %s\n  %9s%10s%10s%10s%10s%10s%10s  flagged, refused, silent\n", s->name, s->about,
           s->unit[0] ? s->unit : "severity", "albedo", "largest", "rho_s", "alpha", "relit",
           "in 95 %");
    for (size_t i = 0; i < s->point_count; i++) print_errors(&s->points[i]);
    if (s->breakdown < s->point_count)
        printf("  breaks down at %.6g %s\n", s->points[s->breakdown].severity, s->unit);
}

static void print_stability_json(const igi_stability *all)
{
    printf("{\"cases\": %zu, \"silent\": %zu, \"sweeps\": {", all->cases, all->silent);
    for (size_t i = 0; i < all->sweep_count; i++) {
        const igi_sweep_result *s = &all->sweeps[i];
        fputs(i ? ", " : "", stdout);
        cli_print_json_string(s->name);
        fputs(": [", stdout);
        for (size_t k = 0; k < s->point_count; k++) {
            const igi_sweep_point *p = &s->points[k];
            printf("%s{\"severity\": %.6g, \"cases\": %zu, \"flagged\": %zu, \"refused\": %zu, "
                   "\"silent\": %zu, \"albedo\": ",
                   k ? ", " : "", p->severity, p->cases, p->flagged, p->refused, p->silent);
            cli_print_json_number(p->albedo);
            fputs(", \"covered\": ", stdout);
            cli_print_json_number(p->covered);
            putchar('}');
        }
        putchar(']');
    }
    puts("}}");
}

/* As rows of a Markdown table. */
static void print_goals(const igi_stability *all)
{
    puts("\n| what | wanted | found | |\n| --- | ---: | ---: | --- |");
    for (size_t i = 0; i < all->goal_count; i++) {
        const igi_stability_goal *goal = &all->goals[i];
        printf("| %s | %s %g %% | %.3g %% | %s |\n", goal->what,
               goal->at_least ? ">=" : "<=", 100 * goal->wanted, 100 * goal->found,
               goal->met ? "PASS" : "MISS");
    }
}

static igi_status run_stability(cli_session *s, const igi_chart_options *options,
                                const char *folder)
{
    igi_stability *all = NULL;
    igi_status status = igi_chart_stability(s->context, options, folder, &all);
    cli_progress_clear(&s->progress);
    if (status != IGI_OK) return status;
    if (s->values.json) {
        print_stability_json(all);
    } else if (!s->values.quiet) {
        for (size_t i = 0; i < all->sweep_count; i++) print_sweep(&all->sweeps[i]);
        double share = all->cases ? (double)all->silent / (double)all->cases : 0;
        printf("\n%zu cases; silent failures: %zu, ", all->cases, all->silent);
        cli_print_percent(share, 0);
        puts("");
        print_goals(all);
    }
    igi_stability_destroy(all);
    return IGI_OK;
}

static igi_status save_manifest(cli_session *s, const char *folder)
{
    igi_setting settings[24];
    char numbers[24][32], command[4096];
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command,
                             .setting_count = cli_settings(s, settings, numbers, 24),
                             .settings = settings};
    return igi_manifest_save(s->context, &manifest, folder);
}

/* Draws into a new folder, which appears when it is whole. */
static igi_status draw(cli_session *s, const igi_chart_options *options, const char *kind)
{
    igi_output *output = NULL;
    igi_status status = igi_output_begin(s->context, s->values.output, s->values.force, NULL,
                                         &output);
    const char *folder = status == IGI_OK ? igi_output_folder(output) : NULL;
    if (status == IGI_OK && strcmp(kind, "speed") == 0)
        status = igi_chart_speed(s->context, options, folder);
    else if (status == IGI_OK && strcmp(kind, "parsimony") == 0)
        status = igi_chart_parsimony(s->context, options, folder);
    else if (status == IGI_OK) status = run_stability(s, options, folder);
    if (status == IGI_OK) status = save_manifest(s, folder);
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    igi_output_destroy(output);
    cli_progress_clear(&s->progress);
    bool told = s->values.json && strcmp(kind, "stability") == 0;
    if (status == IGI_OK && !told && cli_begin_written(s, s->values.output)) puts("}");
    else if (status == IGI_OK && !told && !s->values.quiet)
        printf("%s: written; look at %s/%s.png\n", s->values.output, s->values.output, kind);
    return status;
}

static char *copy(const char *text)
{
    char *own = text ? malloc(strlen(text) + 1) : NULL;
    if (own) memcpy(own, text, strlen(text) + 1);
    return own;
}

static igi_status run(cli_session *s)
{
    const cli_values *v = &s->values;
    const char *scenes[MAX_NAMES], *sweeps[MAX_NAMES], *kind = s->arguments[0];
    static const char *const kinds[] = {"speed", "parsimony", "stability", NULL};
    bool known = false;
    for (int k = 0; kinds[k]; k++) known |= strcmp(kind, kinds[k]) == 0;
    if (!known) {
        const char *nearest = cli_nearest(kind, kinds);
        fprintf(stderr, "igi: chart '%s': there are speed, parsimony and stability%s%s%s\n", kind,
                nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
        return IGI_E_USAGE;
    }
    if (!v->output) {
        fprintf(stderr, "igi: chart: where to? give a folder with -o\n");
        return IGI_E_USAGE;
    }
    igi_chart_options options;
    igi_chart_options_init(&options);
    char *scene_list = copy(v->scenes), *sweep_list = copy(v->sweeps);
    int scene_count = cut_list(scene_list, scenes, 0),
        sweep_count = cut_list(sweep_list, sweeps, 0);
    for (int i = 1; i < s->argument_count && scene_count >= 0; i++) /* --scenes A B C */
        if (scene_count < MAX_NAMES) scenes[scene_count++] = s->arguments[i];
        else scene_count = -1;
    if (scene_count < 0 || sweep_count < 0) {
        fprintf(stderr, "igi: chart: more than %d names\n", MAX_NAMES);
        free(scene_list);
        free(sweep_list);
        return IGI_E_USAGE;
    }
    options.scene_count = (size_t)scene_count;
    options.scenes = scenes;
    options.sweep_count = (size_t)sweep_count;
    options.sweeps = sweeps;
    options.datasets = v->datasets;
    options.cache = v->cache;
    options.seeds = (int)v->seeds;
    options.small = v->small;
    options.peer = v->peer;
    options.relit = v->relit;
    igi_status status = draw(s, &options, kind);
    free(scene_list);
    free(sweep_list);
    return status;
}

const cli_command cli_chart = {
    .name = "chart",
    .bit = CLI_CHART,
    .arguments = 1,
    .more = true,
    .usage = "chart speed|parsimony|stability -o DIR",
    .summary = "errors against time, parameters, broken assumptions",
    .example = "igi chart stability -o charts --sweeps misregistered-cameras --seeds 2",
    .details =
        "speed: every method with a ladder of budgets on each scene, against truth.\n"
        "parsimony: error against the number of parameters: without lobes, as igi chooses,\n"
        "and with a map on every region; each with ever coarser maps.\n"
        "stability: one assumption of the method is broken, more and more (a file of\n"
        "datasets-synthetic/sweeps each); how wrong are the results, do the stated intervals\n"
        "hold, and does igi say so? DIR receives CSV, SVG and PNG.",
    .run = run,
};
