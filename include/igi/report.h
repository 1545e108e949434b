/* SPDX-License-Identifier: Apache-2.0
 *
 * Evidence: errors against truth, and a page to look at.
 */
#ifndef IGI_REPORT_H
#define IGI_REPORT_H

#include <igi/recover.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One region compared with truth. Errors are relative: |got - want| / max(want, .02), the mean
 * over bands. A field that does not apply is NaN. */
typedef struct igi_region_error {
    char *region;
    bool judged;  /* false: an emitter, or less than a fifth of it is seen */
    bool missing; /* the result does not have it: counts as an albedo error of 1 */
    double albedo;
    double texture_median, texture_mean, texture_seen; /* over texels that photographs determine */
    double specular, alpha;
    igi_model got, want;
    /* The numbers of the lobe: recovered, their standard deviation, true; NaN where there is none. */
    double specular_values[3], alpha_values[3];
    bool coloured, want_coloured; /* lobes: `specular` is then the mean error of their bands */
    double specular_rgb_z[IGI_MAX_BANDS]; /* where both are coloured; else NaN */
    double sigmas;                        /* largest over bands of |albedo_z| */
    /* got - want in units of the stated standard deviation; NaN where none is stated. */
    double albedo_z[IGI_MAX_BANDS], specular_z, alpha_z;
} igi_region_error;

typedef struct igi_validation {
    int bands;
    size_t region_count;
    igi_region_error *regions;
    double albedo_mean, albedo_median, albedo_max, specular_mean, alpha_mean, texture_median;
    int models, models_right;
    int glossy_right, glossy_false, glossy_missed; /* lobes found, invented, missed */
} igi_validation;

/* Compares the folder that recovery wrote with a truth folder. */
IGI_API IGI_MUST_USE igi_status igi_validate(igi_context *context, const char *folder,
                                             const char *truth_folder, igi_validation **validation);
/* The same of materials in memory, those of one scene both. */
IGI_API IGI_MUST_USE igi_status igi_validate_materials(igi_context *context,
                                                       const igi_materials *got,
                                                       const igi_materials *truth,
                                                       igi_validation **validation);
IGI_API void igi_validation_destroy(igi_validation *validation);

/* Writes FOLDER/comparison/NAME.photo.png, NAME.prediction.png, NAME.difference.png and
 * NAME.albedo.png for some frames of the recovery, tone-mapped, spread over the views, at most 256
 * pixels wide; and index.json, which says how. What igi_report shows. */
IGI_API IGI_MUST_USE igi_status igi_comparisons_save(igi_context *context,
                                                     const igi_recovery *recovery,
                                                     const char *folder);

/* Writes FOLDER/evidence.json: of each region the models that were tried, what each gained, and how
 * many numbers the region was given. The same recovery, the same bytes. */
IGI_API IGI_MUST_USE igi_status igi_evidence_save(igi_context *context,
                                                  const igi_recovery *recovery, const char *folder);

/* Writes FOLDER/report.html, one self-contained page, from what is in the folder: materials.json,
 * manifest.json, evidence.json, the maps and comparison/. With a truth folder (NULL: none) every
 * material stands beside its truth. */
IGI_API IGI_MUST_USE igi_status igi_report(igi_context *context, const char *folder,
                                           const char *truth_folder);

#ifdef __cplusplus
}
#endif
#endif
