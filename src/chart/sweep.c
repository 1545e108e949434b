/* SPDX-License-Identifier: Apache-2.0
 *
 * Reading a sweep's file (datasets-synthetic/README.md).
 */
#include "chart/sweep.h"

#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const chart_perturbation *find_kind(const char *name)
{
    static const chart_perturbation *const tables[] = {
        chart_perturb_photos,  chart_perturb_pixels, chart_perturb_cameras, chart_perturb_mesh,
        chart_perturb_regions, chart_perturb_lights, chart_perturb_glass};
    for (size_t t = 0; t < COUNT(tables); t++)
        for (const chart_perturbation *p = tables[t]; p->name; p++)
            if (strcmp(p->name, name) == 0) return p;
    return NULL;
}

static igi_status read_change(igi_context *ctx, const igi_json *root, chart_change *change)
{
    static const char *const known[] = {"kind", "way", "regions", "size"};
    igi_json at = igi_json_member(root, "perturb");
    change->way = "";
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_object(ctx, &at));
    IGI_TRY(igi_json_check_keys(ctx, &at, known, COUNT(known)));
    igi_json kind = igi_json_member(&at, "kind"), way = igi_json_member(&at, "way"),
             regions = igi_json_member(&at, "regions"), size = igi_json_member(&at, "size");
    const char *name;
    IGI_TRY(igi_json_string(ctx, &kind, &name));
    change->kind = find_kind(name);
    if (!change->kind) return igi_json_fail(ctx, &kind, "no perturbation is \"%s\"", name);
    if (way.value) IGI_TRY(igi_json_string(ctx, &way, &change->way));
    if (size.value) IGI_TRY(igi_json_number(ctx, &size, &change->size));
    if (!regions.value) return IGI_OK;
    IGI_TRY(igi_json_array(ctx, &regions, &change->region_count));
    IGI_TRY(IGI_ALLOC(ctx, change->region_count, &change->regions));
    for (size_t i = 0; i < change->region_count; i++) {
        igi_json one = igi_json_element(&regions, i);
        IGI_TRY(igi_json_string(ctx, &one, &change->regions[i]));
    }
    return IGI_OK;
}

/* Paths in the file are relative to it; those of --scenes to the working directory. */
static igi_status read_bases(igi_context *ctx, const char *path, const igi_chart_options *options,
                             chart_sweep *s)
{
    igi_json at = igi_json_member(&s->root, "base");
    size_t count = options->scene_count;
    if (!count) IGI_TRY(igi_json_array(ctx, &at, &count));
    if (!count) return igi_json_fail(ctx, &at, "is empty; name a spec at least");
    IGI_TRY(IGI_ALLOC(ctx, count, &s->bases));
    for (size_t i = 0; i < count; i++) {
        igi_json one = igi_json_element(&at, i);
        const char *name;
        s->base_count++;
        if (options->scene_count) {
            IGI_TRY(igi_strdup(ctx, options->scenes[i], &s->bases[i]));
            continue;
        }
        char *folder;
        IGI_TRY(igi_json_string(ctx, &one, &name));
        IGI_TRY(igi_path_folder(ctx, path, &folder));
        igi_status status = igi_path_join(ctx, folder, name, &s->bases[i]);
        igi_free(folder);
        IGI_TRY(status);
    }
    return IGI_OK;
}

static igi_status read_severities(igi_context *ctx, bool small, chart_sweep *s)
{
    igi_json few = igi_json_member(&s->root, "small"),
             all = igi_json_member(&s->root, "severities");
    s->in_small = few.value != NULL;
    const igi_json *at = small && few.value ? &few : &all;
    IGI_TRY(igi_json_array(ctx, at, &s->severity_count));
    if (!s->severity_count) return igi_json_fail(ctx, at, "is empty");
    IGI_TRY(IGI_ALLOC(ctx, s->severity_count, &s->severities));
    return igi_json_numbers(ctx, at, s->severity_count, s->severities);
}

static igi_status read_head(igi_context *ctx, chart_sweep *s)
{
    double version;
    igi_json number = igi_json_member(&s->root, "igi_sweep"),
             name = igi_json_member(&s->root, "name"), about = igi_json_member(&s->root, "about"),
             subject = igi_json_member(&s->root, "subject"),
             axis = igi_json_member(&s->root, "axis"), label = igi_json_member(&axis, "label"),
             unit = igi_json_member(&axis, "unit"), model = igi_json_member(&s->root, "model");
    IGI_TRY(igi_json_number(ctx, &number, &version));
    if (version != 1)
        return igi_json_fail(ctx, &number, "is %g; this program reads version 1", version);
    IGI_TRY(igi_json_string(ctx, &name, &s->name));
    IGI_TRY(igi_json_string(ctx, &about, &s->about));
    IGI_TRY(igi_json_object(ctx, &axis));
    IGI_TRY(igi_json_string(ctx, &label, &s->label));
    s->unit = s->subject = "";
    if (subject.value) IGI_TRY(igi_json_string(ctx, &subject, &s->subject));
    if (unit.value) IGI_TRY(igi_json_string(ctx, &unit, &s->unit));
    s->model = IGI_ANY_MODEL;
    if (!model.value) return IGI_OK;
    const char *word;
    igi_model found;
    IGI_TRY(igi_json_string(ctx, &model, &word));
    if (!igi_model_from_name(word, &found))
        return igi_json_fail(ctx, &model, "no model is \"%s\"", word);
    s->model = (int)found;
    return IGI_OK;
}

igi_status chart_sweep_load(igi_context *ctx, const char *path, const igi_chart_options *options,
                            chart_sweep *s)
{
    static const char *const known[] = {"igi_sweep", "name",  "subject", "about", "axis",
                                        "base",      "set",   "perturb", "model", "severities",
                                        "small",     "seeds", "wanted"};
    *s = (chart_sweep){.seeds = 5};
    IGI_TRY(igi_json_load(ctx, path, &s->file));
    s->root = igi_json_root(&s->file);
    IGI_TRY(igi_json_object(ctx, &s->root));
    IGI_TRY(igi_json_check_keys(ctx, &s->root, known, COUNT(known)));
    IGI_TRY(read_head(ctx, s));
    IGI_TRY(read_bases(ctx, path, options, s));
    s->set = igi_json_member(&s->root, "set");
    if (s->set.value) IGI_TRY(igi_json_object(ctx, &s->set));
    IGI_TRY(read_change(ctx, &s->root, &s->change));
    IGI_TRY(read_severities(ctx, options->small, s));
    IGI_TRY(chart_goals_read(ctx, s));
    igi_json seeds = igi_json_member(&s->root, "seeds");
    double count = s->seeds;
    if (seeds.value) IGI_TRY(igi_json_number(ctx, &seeds, &count));
    if (!(count >= 1 && count <= 1000))
        return igi_json_fail(ctx, &seeds, "is %g; give 1 to 1000", count);
    s->seeds = options->seeds ? options->seeds : options->small ? 1 : (int)count;
    return IGI_OK;
}

void chart_sweep_clear(chart_sweep *s)
{
    for (size_t i = 0; s->bases && i < s->base_count; i++) igi_free(s->bases[i]);
    igi_free(s->bases);
    igi_free(s->change.regions);
    igi_free(s->severities);
    igi_free(s->goals);
    if (s->file.root) igi_json_unload(&s->file);
}
