/* SPDX-License-Identifier: Apache-2.0
 *
 * What other modules may use of hdr beyond <igi/hdr.h>.
 */
#ifndef IGI_SRC_HDR_HDR_H
#define IGI_SRC_HDR_HDR_H

#include <igi/hdr.h>

/* The exposure h, as igi_exposure defines it. */
double igi_hdr_exposure(const igi_exposure *exposure);

#endif
