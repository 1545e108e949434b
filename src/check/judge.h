/* SPDX-License-Identifier: Apache-2.0
 *
 * The judges: each looks at some of what the method assumes, and adds its findings to the case.
 */
#ifndef IGI_SRC_CHECK_JUDGE_H
#define IGI_SRC_CHECK_JUDGE_H

#include "check/case.h"

IGI_MUST_USE igi_status igi_judge_photographs(const igi_case *c);
IGI_MUST_USE igi_status igi_judge_mesh(const igi_case *c);
IGI_MUST_USE igi_status igi_judge_light(const igi_case *c);
IGI_MUST_USE igi_status igi_judge_coverage(const igi_case *c);

#endif
