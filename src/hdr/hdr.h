/* SPDX-License-Identifier: Apache-2.0
 *
 * What other modules may use of hdr beyond <igi/hdr.h>.
 */
#ifndef IGI_SRC_HDR_HDR_H
#define IGI_SRC_HDR_HDR_H

#include <igi/hdr.h>

/* The exposure h, as igi_exposure defines it. */
double igi_hdr_exposure(const igi_exposure *exposure);

/* The EMoR model's table of inverse responses (Grossberg and Nayar 2003), which igi does not carry:
 * the mean and the first components, over codes from 0 to 1. *table is the caller's. */
#define IGI_HDR_TABLE 1024
#define IGI_HDR_COMPONENTS 4
IGI_MUST_USE igi_status igi_hdr_load_basis(igi_context *ctx, const char *path,
                                           double (**table)[IGI_HDR_TABLE]);

#endif
