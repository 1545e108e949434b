/* SPDX-License-Identifier: Apache-2.0
 *
 * igi recover: photographs, mesh and cameras in; materials, their error bars and a report out.
 */
#include "cli.h"

#include <stdlib.h>
#include <string.h>

static igi_status fail(const char *path, const char *what)
{
    fprintf(stderr, "igi: %s: %s\n", path, what);
    return IGI_E_SYSTEM;
}

static void set_options(const cli_values *values, igi_recover_options *options)
{
    igi_recover_options_init(options);
    bool known = igi_method_from_name(values->method, &options->method);
    (void)known; /* the table of options lets no other name through */
    igi_model model;
    if (igi_model_from_name(values->model, &model)) options->model = (int)model; /* else auto */
    if (strcmp(values->form_factors, "hemicube") == 0)
        options->form_factors = IGI_FORM_FACTORS_BY_HEMICUBE;
    if (strcmp(values->form_factors, "closed") == 0)
        options->form_factors = IGI_FORM_FACTORS_CLOSED;
    options->gather_from_photos = strcmp(values->gather_from, "photos") == 0;
    if (strcmp(values->registering, "never") == 0) options->registering = IGI_REGISTER_NEVER;
    if (strcmp(values->registering, "always") == 0) options->registering = IGI_REGISTER_ALWAYS;
    options->patch_m = values->patch;
    options->rays = (int)values->rays;
    options->map_size = (int)values->map_size;
    options->target_error = values->target_error;
    options->time_budget_s = values->time_budget;
}

/* What the scene was read from, and every photograph that was. */
static igi_status save_manifest(cli_session *s, const igi_scene *scene, const bool *read,
                                const char *folder)
{
    igi_setting settings[24];
    char numbers[24][32], command[4096];
    size_t count = 0;
    const char **inputs = calloc(scene->file_count + scene->frame_count + 1, sizeof *inputs);
    if (!inputs) return fail("memory", "no room for the list of inputs");
    for (size_t i = 0; i < scene->file_count; i++) inputs[count++] = scene->files[i];
    for (size_t i = 0; i < scene->frame_count; i++) /* exposures are among the files */
        if (!scene->frames[i].exposure_count && (!read || read[i]))
            inputs[count++] = scene->frames[i].path;
    cli_command_line(s, command, sizeof command);
    igi_manifest manifest = {.command = command,
                             .setting_count = cli_settings(s, settings, numbers, 24),
                             .settings = settings,
                             .input_count = count,
                             .inputs = inputs};
    igi_status status = igi_manifest_save(s->context, &manifest, folder);
    free(inputs);
    return status;
}

static igi_status write_results(cli_session *s, const igi_scene *scene,
                                const igi_recovery *recovery, const char *folder)
{
    char path[4096];
    igi_context *context = s->context;
    igi_status status = igi_materials_save(context, recovery->materials, scene, folder);
    snprintf(path, sizeof path, "%s/scene.glb", folder);
    if (status == IGI_OK)
        status = igi_materials_save_glb(context, recovery->materials, scene, path);
    if (status == IGI_OK) status = igi_comparisons_save(context, recovery, folder);
    if (status == IGI_OK) status = save_manifest(s, scene, recovery->read, folder);
    if (status == IGI_OK) status = igi_evidence_save(context, recovery, folder);
    if (status == IGI_OK) status = igi_report(context, folder, NULL);
    return status;
}

static double largest_share(const igi_material *m, int bands)
{
    double largest = 0;
    for (int b = 0; b < bands; b++) {
        double share = m->albedo[b] > 0 ? m->albedo_std[b] / m->albedo[b] : m->albedo_std[b];
        if (share > largest) largest = share;
    }
    return largest;
}

static bool has_lobes(const igi_materials *materials)
{
    bool lobes = false;
    for (size_t i = 0; i < materials->count; i++)
        lobes |= materials->materials[i].model != IGI_LAMBERT;
    return lobes;
}

static void print_table(const igi_materials *materials, const char *output)
{
    int width = 6;
    for (size_t i = 0; i < materials->count; i++) {
        int w = cli_text_width(materials->materials[i].region);
        if (w > width) width = w;
    }
    int bands = materials->bands;
    bool lobes = has_lobes(materials);
    cli_print_padded("region", width);
    printf("  model    %-*s   1 sigma%s  observed  views\n", 7 * bands,
           bands == 3 ? "albedo R, G, B" : "albedo", lobes ? "  specular   alpha" : "");
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        if (m->emitter) continue;
        cli_print_padded(m->region, width);
        printf("  %-7s ", igi_model_name(m->model));
        for (int b = 0; b < bands; b++) printf(" %6.4f", m->albedo[b]);
        fputs("  ", stdout);
        if (m->determined) cli_print_percent(largest_share(m, bands), 10);
        else fputs("not seen  ", stdout);
        if (lobes && m->model != IGI_LAMBERT) printf("  %8.4f  %6.4f", m->specular, m->alpha);
        else if (lobes) printf("  %8s  %6s", "-", "-");
        printf("  %6.1f %%  %5d%s\n", 100 * m->observed, m->views,
               m->warning_count ? "  see the report" : "");
    }
    printf("%s: written; look at %s/report.html\n", output, output);
}

static igi_status print_file(const char *folder, const char *name)
{
    char path[4096], block[8192];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) return fail(path, "cannot be read");
    for (size_t n; (n = fread(block, 1, sizeof block, file)) > 0;) fwrite(block, 1, n, stdout);
    puts("");
    fclose(file);
    return IGI_OK;
}

static void print_plan(const igi_scene *scene, const cli_values *values)
{
    size_t pixels = 0;
    for (size_t i = 0; i < scene->frame_count; i++)
        pixels += (size_t)scene->frames[i].camera.width * (size_t)scene->frames[i].camera.height;
    const struct {
        const char *one, *many;
        size_t count;
    } parts[] = {{"photograph", "photographs", scene->frame_count},
                 {"pixel", "pixels", pixels},
                 {"band", "bands", (size_t)scene->bands},
                 {"triangle", "triangles", scene->mesh.triangle_count},
                 {"region", "regions", scene->region_count},
                 {"light", "lights", scene->light_count}};
    if (values->json) fputs("{\"scene\": ", stdout);
    if (values->json) cli_print_json_string(scene->name);
    else printf("%s:", scene->name);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (values->json) printf(", \"%s\": %zu", parts[i].many, parts[i].count);
        else
            printf("%s %zu %s", i ? "," : "", parts[i].count,
                   parts[i].count == 1 ? parts[i].one : parts[i].many);
    }
    if (values->json) puts("}");
    else
        printf("\nwould recover by %s%s%s; nothing was written\n", values->method,
               values->output ? " into " : "", values->output ? values->output : "");
}

static igi_status recover_into(cli_session *s, const igi_scene *scene, igi_output *output)
{
    igi_recover_options options;
    igi_recovery *recovery = NULL;
    const cli_values *values = &s->values;
    set_options(values, &options);
    igi_status status = igi_recover(s->context, scene, &options, &recovery);
    if (status == IGI_OK) status = write_results(s, scene, recovery, igi_output_folder(output));
    if (status == IGI_OK) status = igi_output_commit(s->context, output);
    cli_progress_clear(&s->progress);
    if (status == IGI_OK && values->json) status = print_file(values->output, "materials.json");
    else if (status == IGI_OK && !values->quiet) print_table(recovery->materials, values->output);
    igi_recovery_destroy(recovery);
    return status;
}

/* An option that would change nothing is a mistake of the user's; so is a result without a place. */
static bool is_usage_right(const cli_values *v)
{
    const char *mistake = NULL;
    if (!v->output && !v->dry_run) mistake = "where to? give a folder with -o";
    if (strcmp(v->gather_from, "patches") != 0 && strcmp(v->method, "gather") != 0)
        mistake = "--gather-from photos is for --method gather; give that, too, or leave it out";
    if (strcmp(v->form_factors, "rays") != 0 && strcmp(v->method, "radiosity") != 0)
        mistake = "--form-factors is for --method radiosity; give that, too, or leave it out";
    if (mistake) fprintf(stderr, "igi: recover: %s\n", mistake);
    return !mistake;
}

static igi_status run(cli_session *s)
{
    const char *path = s->arguments[0];
    igi_scene *scene = NULL;
    igi_output *output = NULL;
    if (!is_usage_right(&s->values)) return IGI_E_USAGE;
    cli_progress_report(s, "scene", 0);
    igi_status status = igi_scene_load(s->context, path, &scene);
    if (status == IGI_OK && s->values.dry_run) {
        status = igi_photographs_check(s->context, scene);
        cli_progress_clear(&s->progress);
        if (status == IGI_OK) print_plan(scene, &s->values);
    } else if (status == IGI_OK) {
        status = igi_output_begin(s->context, s->values.output, s->values.force, path, &output);
        if (status == IGI_OK) status = recover_into(s, scene, output);
    }
    igi_output_destroy(output);
    igi_scene_destroy(scene);
    return status;
}

const cli_command cli_recover = {
    .name = "recover",
    .bit = CLI_RECOVER,
    .arguments = 1,
    .usage = "recover SCENE -o OUT",
    .summary = "materials with error bars from photographs, mesh and cameras",
    .example = "igi recover my-room -o my-room.out",
    .details =
        "SCENE is a folder with scene.json, mesh, cameras and radiance images; or photographs,\n"
        "where scene.json names \"brackets\" and a \"calibration\" to undo. OUT receives\n"
        "materials.json, albedo/ and uncertainty/ (maps), scene.glb, manifest.json and\n"
        "report.html. truth/, heldout/ and relit*/ in SCENE are never opened.",
    .run = run,
};
