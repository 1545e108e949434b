/* SPDX-License-Identifier: Apache-2.0
 *
 * igi: inverse global illumination. Everything, in the order in which data flows.
 */
#ifndef IGI_IGI_H
#define IGI_IGI_H

#include <igi/base.h>
#include <igi/output.h>
#include <igi/image.h>
#include <igi/photo.h>
#include <igi/hdr.h>
#include <igi/scene.h>
#include <igi/lens.h>
#include <igi/register.h>
#include <igi/material.h>
#include <igi/check.h>
#include <igi/recover.h>
#include <igi/export.h>
#include <igi/render.h>
#include <igi/synth.h>
#include <igi/report.h>
#include <igi/chart.h>

#endif
