/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of the speed chart share: one line of its table, and the pictures of it.
 */
#ifndef IGI_SRC_CHART_SPEED_H
#define IGI_SRC_CHART_SPEED_H

#include "chart/case.h"
#include "chart/relit.h"

#include <igi/output.h>

/* One method with one budget on one scene. Errors as igi_validation's; NaN: does not apply. */
typedef struct speed_row {
    const char *scene; /* the name of its scene; the scene's */
    igi_method method;
    double patch_m;     /* the budget: side of a patch, */
    int rays_each;      /* and rays of each; 0: the method's own */
    double target;      /* or the error that was asked for; 0: none */
    size_t photographs; /* that were read */
    bool refused;
    double albedo, albedo_max, specular, alpha, texels, relit;
    int models_right, models;
    size_t parameters; /* numbers that the result consists of */
    uint64_t rays;
    double cpu_s, ratio; /* of the recovery; over the reference kernel's */
    uint64_t peak_bytes;
    bool front; /* nothing as quick is more accurate: mean albedo against CPU time */
} speed_row;

typedef struct speed_rows {
    size_t count, capacity;
    speed_row *rows;
} speed_rows;

/* A result made simpler: its parameters, and the error of albedo texel by texel. */
typedef struct spare_row {
    const char *scene, *model; /* "lambert": no lobes; "auto": where evidence asks for them;
                                * "maps": and a map on every region */
    int map_size;              /* largest side of a map; 0: one albedo a region */
    bool chosen;               /* what igi does by itself */
    size_t parameters, lobes;
    double error, specular;
} spare_row;

typedef struct spare_rows {
    size_t count, capacity;
    spare_row *rows;
} spare_rows;

/* A point of a peer's curve: from this time on its error stays below. */
typedef struct peer_point {
    double cpu_s, errors[4]; /* albedo, specular, alpha, texels; NaN: none */
} peer_point;

typedef struct peer_curve {
    char peer[64], scene[64];
    size_t count, capacity;
    peer_point *points; /* in the order of time */
} peer_curve;

typedef struct peer_curves {
    size_t count, capacity;
    peer_curve *curves;
} peer_curves;

enum { SPEED_STANDARD_SCENES = 2 };

/* A scene of the chart. */
typedef struct speed_subject {
    igi_scene *scene;
    igi_materials *truth;
    double patch_m;    /* the standard one */
    double load_s;     /* CPU seconds that loading the scene took */
    chart_relit relit; /* by novel lights, as the first camera sees it; or nothing */
} speed_subject;

typedef struct speed_subjects {
    size_t count;
    speed_subject *all;
    igi_output *scratch; /* where specs were rendered, unless there is a cache */
} speed_subjects;

/* Loads the scenes of the options, or the standard ones where they name none; specs are rendered
 * first, unless the options' cache has them. */
IGI_MUST_USE igi_status speed_subjects_make(igi_context *ctx, const igi_chart_options *options,
                                            const char *folder, speed_subjects *subjects);
void speed_subjects_clear(speed_subjects *subjects);

/* CPU seconds of a fixed piece of work, a million rays and their random numbers: what times are
 * divided by to compare machines and days. */
IGI_MUST_USE igi_status chart_reference_seconds(igi_context *ctx, double *seconds);

size_t chart_parameters(const igi_materials *materials);

/* Recovers the scene with no lobes, as evidence asks, and with a map on every region, and adds the
 * simpler forms of each result. */
IGI_MUST_USE igi_status chart_spare_scene(igi_context *ctx, const speed_subject *subject,
                                          spare_rows *rows);

/* Reads what scripts/peers write: CSV with the columns peer, run, scene, cpu_s, albedo_mean,
 * specular, alpha, texels; of several runs of a peer on a scene the best of each time counts. */
IGI_MUST_USE igi_status chart_peers_load(igi_context *ctx, const char *path, peer_curves *curves);
void chart_peers_clear(peer_curves *curves);

/* CSV tables and pictures in the folder. */
IGI_MUST_USE igi_status chart_speed_save(igi_context *ctx, const speed_rows *rows,
                                         const peer_curves *peers, const char *folder);
IGI_MUST_USE igi_status chart_spare_save(igi_context *ctx, const spare_rows *rows,
                                         const char *folder);

#endif
