/* SPDX-License-Identifier: Apache-2.0
 *
 * How much of the usual pixels and rays lobes need for the error that was asked for.
 */
#ifndef IGI_SRC_SPECULAR_EFFORT_H
#define IGI_SRC_SPECULAR_EFFORT_H

#include <igi/recover.h>

#include <math.h>

/* What they usually reach; noise falls with the root of what is spent. */
#define IGI_LOBE_ERROR 0.003
#define IGI_LEAST_EFFORT 0.2

static inline double igi_lobe_effort(const igi_recover_options *options)
{
    double more = options->target_error / IGI_LOBE_ERROR;
    return more > 1 ? fmax(IGI_LEAST_EFFORT, 1 / (more * more)) : 1;
}

#endif
