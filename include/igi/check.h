/* SPDX-License-Identifier: Apache-2.0
 *
 * Before the long work: what the photographs of a scene can determine, which assumption of the
 * method holds, and what to do about those that do not.
 */
#ifndef IGI_CHECK_H
#define IGI_CHECK_H

#include <igi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* doubtful: recovery runs and says so, or its error bars grow; fails: it has no answer. */
typedef enum igi_verdict { IGI_HOLDS, IGI_DOUBTFUL, IGI_FAILS } igi_verdict;

IGI_API const char *igi_verdict_name(igi_verdict verdict);

typedef struct igi_assumption {
    const char *name; /* a word: static, exposure, unclipped, registered, closed, mesh, lights,
                         energy, observed, surroundings, highlights, conditioned */
    igi_verdict verdict;
    double number; /* behind the verdict, as the finding words it; NaN: none */
    char *finding; /* a sentence */
    char *remedy;  /* what to do; NULL when it holds */
    bool has_view; /* the remedy is a photograph from about `eye`, looking at `target` */
    double eye[3], target[3];
    int region; /* that it is about first of all; -1: none */
    int frame;  /* likewise */
} igi_assumption;

typedef struct igi_region_check {
    char *name;
    bool emitter;
    double area;                          /* m^2 */
    double observed;                      /* share of its area that a photograph shows, */
    double seen_once;                     /* and that only one does */
    int views;                            /* photographs that show it */
    double angle_low_deg, angle_high_deg; /* of the views from its normal; NaN when it is unseen */
    double unseen; /* cosine-weighted share of what its seen parts face that no photograph shows, */
    double escaped;           /* and that the mesh does not close */
    int highlights_predicted; /* (place, photograph) pairs that mirror a lamp, of those looked at, */
    int highlights_seen;      /* and how many of them are usable: not clipped, not at an edge */
    double albedo[IGI_MAX_BANDS]; /* a first estimate, some per cent; NaN where there is none */
} igi_region_check;

typedef struct igi_light_check {
    igi_light_type type;
    char *name; /* of an area light's region; else its type */
    bool known; /* its value is given */
    bool seen;  /* area: a photograph shows its front */
} igi_light_check;

typedef struct igi_photo_check {
    char *name;
    double gain, gain_error; /* against the others */
    double contradicts;      /* share of the places it shares with others at which it is alone */
    double saturated;        /* share of its pixels that a merge marked or that are cut off */
    size_t edges;            /* on which the next two rest; few: they are 0 */
    double offset[2], offset_error; /* of its edges from the mesh's, pixels */
    bool left_out, scaled;          /* what recovery will do with it */
} igi_photo_check;

typedef struct igi_check {
    igi_verdict verdict; /* the worst of the assumptions' */
    size_t assumption_count;
    igi_assumption *assumptions;
    size_t region_count;
    igi_region_check *regions;
    size_t light_count;
    igi_light_check *lights;
    size_t photo_count;
    igi_photo_check *photos;
    double unseen_area;      /* share of the mesh that no photograph shows */
    double amplification;    /* 1 / (1 - mean albedo): of errors when relighting; NaN: not known */
    double unseen_condition; /* the same of the system that the unseen surfaces form */
    size_t doubled_faces, flipped_edges; /* of the mesh */
    size_t warning_count;                /* what recovery will warn of */
    char **warnings;
} igi_check;

/* Reads the photographs once; takes about a second. */
IGI_API IGI_MUST_USE igi_status igi_check_scene(igi_context *context, const igi_scene *scene,
                                                igi_check **check);
/* The same, and check.html in the existing folder: a page with pictures that needs nothing else. */
IGI_API IGI_MUST_USE igi_status igi_check_page(igi_context *context, const igi_scene *scene,
                                               const char *folder, igi_check **check);
IGI_API void igi_check_destroy(igi_check *check);

#ifdef __cplusplus
}
#endif
#endif
