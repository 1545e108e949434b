/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs that seemed at fault, judged again once lobes are known.
 */
#ifndef IGI_SRC_RECOVER_EXCUSE_H
#define IGI_SRC_RECOVER_EXCUSE_H

#include "diffuse/problem.h"

/* Takes out of the photographs what problem->lobes account for, and mends and names what is still at
 * fault. *again: a photograph was left out or scaled, and a solution of what remains is asked for.
 * `observations` are the problem's. */
IGI_MUST_USE igi_status igi_excuse_photographs(igi_context *ctx, const igi_problem *problem,
                                               const igi_diffuse *diffuse,
                                               igi_observations *observations, bool *again);

#endif
