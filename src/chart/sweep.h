/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of the stability chart share: a sweep as its file states it, the rooms it starts
 * from, and the ways to break them.
 */
#ifndef IGI_SRC_CHART_SWEEP_H
#define IGI_SRC_CHART_SWEEP_H

#include "base/rng.h"
#include "base/vec.h"
#include "chart/case.h"
#include "chart/relit.h"
#include "scene/json.h"
#include "trace/trace.h"

/* What a perturbation changes: a scene and truth of its own. */
typedef struct chart_subject {
    igi_scene *scene;
    igi_materials *truth;
    igi_image **photos; /* [scene->frame_count] bands and "saturated"; NULL: not asked for */
    bool *spoilt;       /* [scene->frame_count] no longer what its camera saw; NULL with photos */
    uint64_t seed;
} chart_subject;

struct chart_perturbation;

/* "perturb" of a sweep's file. */
typedef struct chart_change {
    const struct chart_perturbation *kind; /* NULL: the spec's settings are all */
    const char *way;                       /* a variant that the kind knows; "" by default */
    size_t region_count;
    const char **regions; /* [region_count] names, owned; the strings are the file's */
    double size;          /* of what is changed; 0: the kind's own */
} chart_change;

/* Changes the subject by `severity`. IGI_E_NO_ANSWER: it has nothing that could be changed so. The
 * streams depend on the subject's seed alone, so that a severity continues the one before. */
typedef igi_status (*chart_perturb_fn)(igi_context *ctx, const chart_change *change,
                                       double severity, chart_subject *subject);
typedef struct chart_perturbation {
    const char *name;
    bool photos; /* it wants them loaded */
    chart_perturb_fn run;
} chart_perturbation;

/* The tables, each ending in a name of NULL. */
extern const chart_perturbation chart_perturb_photos[], chart_perturb_pixels[],
    chart_perturb_cameras[], chart_perturb_mesh[], chart_perturb_regions[], chart_perturb_lights[],
    chart_perturb_glass[];

/* An element of "wanted" says one of these about a severity. */
typedef enum chart_measure {
    CHART_ALBEDO, /* median error of albedo at most so large, */
    CHART_COST,   /* or what it is beyond the unperturbed room's */
    CHART_TOLD, /* share of cases at least whose rho_s lies within its interval, or a word was said */
    CHART_NAMED /* share of the spoilt photographs at least that a warning names */
} chart_measure;

enum { CHART_MEASURES = 4 };

typedef struct chart_goal {
    double at; /* the severity */
    chart_measure measure;
    double limit;
} chart_goal;

/* datasets-synthetic/sweeps/NAME.json. */
typedef struct chart_sweep {
    igi_json_file file;
    igi_json root;
    const char *name, *about, *subject, *label, *unit; /* the file's */
    size_t base_count;
    char **bases; /* [base_count] paths of specs or scene folders */
    igi_json set; /* {"path.to.value": value, ...} in the spec, "$" standing for the severity */
    chart_change change;
    int model; /* of igi_recover_options */
    size_t severity_count;
    double *severities;
    int seeds;
    size_t goal_count;
    chart_goal *goals;
    bool in_small; /* has "small" severities, and is part of the small edition */
} chart_sweep;

/* `options` choose bases, severities and seeds where they say so. */
IGI_MUST_USE igi_status chart_sweep_load(igi_context *ctx, const char *path,
                                         const igi_chart_options *options, chart_sweep *sweep);
void chart_sweep_clear(chart_sweep *sweep);
/* "wanted", for chart_sweep_load. */
IGI_MUST_USE igi_status chart_goals_read(igi_context *ctx, chart_sweep *sweep);

/* A room to make: a spec with the sweep's settings, rendered with a seed; or a scene folder. */
typedef struct chart_room {
    char *folder; /* where it is, or will be */
    char *spec;   /* text of the spec to render; NULL: nothing is to be rendered */
    uint64_t seed;
    chart_relit relit; /* what results of it are compared with, once the caller has loaded it */
} chart_room;

/* Where the room of that base lies or will lie. `set` may have no value. */
IGI_MUST_USE igi_status chart_room_plan(igi_context *ctx, const char *base, const igi_json *set,
                                        double severity, uint64_t seed, const char *cache,
                                        bool small, chart_room *room);
/* Renders it unless it is there already. */
IGI_MUST_USE igi_status chart_room_make(igi_context *ctx, const chart_room *room);
void chart_room_clear(chart_room *room);

/* What the files of perturbations share. */
igi_rng chart_stream(const chart_subject *subject, const char *what);
double chart_normal(igi_rng *rng);
/* Index of the region of that name; region_count: there is none. */
size_t chart_region(const igi_scene *scene, const char *name);
/* Mean over photographs, pixels and bands. */
double chart_photo_mean(const chart_subject *subject);
/* No word about this region in the comparison with truth. */
void chart_unjudge(igi_materials *truth, const char *region);

/* Writes cases.csv's neighbours: stability.csv and wanted.csv, */
IGI_MUST_USE igi_status chart_stability_save(igi_context *ctx, const igi_stability *stability,
                                             const char *folder);
/* and from them stability.svg and .png. */
IGI_MUST_USE igi_status chart_stability_draw(igi_context *ctx, const igi_stability *stability,
                                             const char *folder);

#endif
