/* SPDX-License-Identifier: Apache-2.0
 *
 * The commands, in the order in which one meets them.
 */
#include "cli.h"

extern const cli_command cli_calibrate, cli_chart, cli_check, cli_correct, cli_export, cli_merge,
    cli_recover, cli_register, cli_relight, cli_report, cli_synth, cli_validate;

const cli_command *const cli_commands[] = {
    &cli_merge,   &cli_calibrate, &cli_correct, &cli_register, &cli_check,
    &cli_recover, &cli_validate,  &cli_report,  &cli_relight,  &cli_export,
    &cli_synth,   &cli_chart,     NULL};
