/* SPDX-License-Identifier: Apache-2.0
 *
 * Recovery: photographs, mesh and cameras in; materials with error bars out.
 */
#ifndef IGI_RECOVER_H
#define IGI_RECOVER_H

#include <igi/material.h>
#include <igi/register.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum igi_method {
    IGI_METHOD_PATCHES,   /* every patch gathers from every other; unseen ones are solved */
    IGI_METHOD_GATHER,    /* one shot: a few points a region gather from the photographs */
    IGI_METHOD_RADIOSITY, /* the classical dense (I - rho F) b = e on a coarse mesh */
    IGI_METHOD_DIRECT,    /* no interreflection */
    IGI_METHOD_YU99       /* the algorithm of 1999: radiosity with lobes, on a coarse mesh */
} igi_method;

IGI_API const char *igi_method_name(igi_method method);
IGI_API bool igi_method_from_name(const char *name, igi_method *method);

#define IGI_ANY_MODEL (-1)

/* How the radiosity method reckons form factors. */
typedef enum igi_form_factor_way {
    IGI_FORM_FACTORS_BY_RAYS,     /* with occlusion */
    IGI_FORM_FACTORS_BY_HEMICUBE, /* with occlusion; Cohen & Greenberg 1985 */
    IGI_FORM_FACTORS_CLOSED       /* exact where nothing stands between; ignores what does */
} igi_form_factor_way;

/* Whether cameras are registered first (igi_register). */
typedef enum igi_registering {
    IGI_REGISTER_AUTO, /* where the photographs' edges lie clearly off the mesh's */
    IGI_REGISTER_NEVER,
    IGI_REGISTER_ALWAYS
} igi_registering;

typedef struct igi_recover_options {
    size_t struct_size;
    igi_method method;   /* default IGI_METHOD_PATCHES */
    double patch_m;      /* side of a patch, metres; 0: from the size of the room (default) */
    int rays;            /* rays a patch (gather: a point); 0: default of the method */
    int map_size;        /* texels along the side of a map; 0: as fine as the photographs */
    int model;           /* IGI_ANY_MODEL (default): evidence decides for each region; or an
                        * igi_model: IGI_LAMBERT looks for no lobe, the others for that one */
    double target_error; /* aimed at: mean over regions of the relative standard deviation of albedo
                             (patches only), from as few photographs, pixels and rays as that
                             needs; 0: the default accuracy */
    double time_budget_s; /* CPU seconds that the diffuse solution may take in all; 0: no limit */
    igi_form_factor_way form_factors; /* radiosity: default IGI_FORM_FACTORS_BY_RAYS */
    igi_registering registering;      /* default IGI_REGISTER_AUTO */
    bool gather_from_photos; /* gather: rays look into the photographs, not at patches (default) */
} igi_recover_options;

IGI_API void igi_recover_options_init(igi_recover_options *options);

/* A picture of one photograph beside what the recovered materials predict for it; written by the
 * recovery for the report, so that nothing is computed twice. */
typedef struct igi_comparison {
    char *frame;
    igi_image *photo, *prediction; /* bands only; the same size */
    igi_image *albedo;             /* likewise: the room without its light; lamps are 1 */
    int regions;                   /* so many of them are in it */
} igi_comparison;

/* One model that was tried on a region's highlights. */
typedef struct igi_model_evidence {
    igi_model model;
    const char *look;          /* "glance", "search" or "refine": with ever more pixels */
    double gain;               /* -2 ln likelihood gained over no lobe; NaN: nothing to judge by */
    double residuals;          /* on which it rests */
    double noise, plain_noise; /* relative deviation of a residual with the lobe, and without */
    double specular, specular_std, alpha;
    bool at_bound;      /* alpha ran into an end of what is looked for: no lobe */
    bool coloured;      /* a coefficient of each band, which gained, */
    double colour_gain; /* in -2 ln likelihood; about so much where it was not asked for */
} igi_model_evidence;

enum { IGI_EVIDENCE_ROOM = 16 };

/* Whether a region has a texture or one albedo: what two halves of the photographs show alike. NaN
 * where it was not asked, because scene.json says, or there is too little to judge by. */
typedef struct igi_texture_evidence {
    bool given;       /* scene.json says */
    double amplitude; /* relative deviation from the surroundings, in the middle */
    double least;     /* what it has to exceed: the irradiance's uncertainty explains as much */
    double agreement; /* of the halves: 1 alike, 0 not */
} igi_texture_evidence;

/* What was spent and tried on a region, in order. */
typedef struct igi_region_evidence {
    igi_texture_evidence texture;
    uint64_t gathered_rays; /* for the light that arrives at it, shadow rays apart */
    uint64_t lobe_rays;     /* for its highlights */
    size_t count;
    igi_model_evidence tried[IGI_EVIDENCE_ROOM];
} igi_region_evidence;

typedef struct igi_recovery {
    igi_materials *materials;
    igi_region_evidence *evidence; /* [materials->count] */
    bool *read;                    /* [frames of the scene] photographs that were read; NULL: all */
    igi_registered *registered;    /* of those that were read; NULL: cameras are as given */
    size_t comparison_count;
    igi_comparison *comparisons;
} igi_recovery;

/* The whole way from photographs to materials. Reads the images that the scene's frames name;
 * never opens truth/, heldout/ or relit*. IGI_E_NO_ANSWER when nothing can be determined. */
IGI_API IGI_MUST_USE igi_status igi_recover(igi_context *context, const igi_scene *scene,
                                            const igi_recover_options *options,
                                            igi_recovery **recovery);
IGI_API void igi_recovery_destroy(igi_recovery *recovery);

#ifdef __cplusplus
}
#endif
#endif
