/* SPDX-License-Identifier: Apache-2.0
 *
 * The specular half of recovery: which regions have a lobe, which one, and what it does to the
 * diffuse half.
 */
#ifndef IGI_SRC_SPECULAR_SPECULAR_H
#define IGI_SRC_SPECULAR_SPECULAR_H

#include "diffuse/field.h"
#include "specular/incident.h"
#include "specular/lobe_doubt.h"
#include "specular/lobe_fit.h"
#include "specular/lobe_view.h"

typedef struct igi_specular {
    igi_lobe_estimate *estimates;  /* [regions]; model IGI_LAMBERT: no lobe */
    igi_lobe_doubt *doubts;        /* [regions] of those without a lobe */
    igi_region_evidence *evidence; /* [regions] what was tried; NULL: it is not kept */
    igi_lobe *lobes;               /* [regions] the same for rendering */
    igi_correction correction;     /* what was taken out of the diffuse half */
    igi_field *irradiance;         /* where no lobe was found: the irradiance, which maps can use */
} igi_specular;

/* Fits lobes to what the patches method has found, takes their light out of the diffuse solution
 * in `diffuse`, and repeats until both agree. */
IGI_MUST_USE igi_status igi_specular_create(igi_context *ctx, const igi_problem *problem,
                                            igi_diffuse *diffuse, igi_specular **specular);
/* For maps and predictions; valid as long as both. */
igi_lobe_view igi_specular_view(const igi_specular *specular, const igi_diffuse *diffuse);
void igi_specular_destroy(igi_specular *specular);

#endif
