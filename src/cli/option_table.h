/* SPDX-License-Identifier: Apache-2.0
 *
 * The one table of options.
 */
#ifndef IGI_SRC_CLI_OPTION_TABLE_H
#define IGI_SRC_CLI_OPTION_TABLE_H

#include "cli.h"

#include <stddef.h>

typedef enum cli_option_kind { FLAG, TEXT, CHOICE, WHOLE, REAL } cli_option_kind;

typedef struct cli_option {
    const char *name;
    char letter; /* 0: none */
    cli_option_kind kind;
    unsigned commands;
    size_t offset;        /* in cli_values */
    const char *value;    /* its name in the help, or the choices: a|b */
    const char *standard; /* the default; NULL: none */
    double low, high;
    const char *help;
} cli_option;

enum { CLI_MAX_OPTIONS = 128 }; /* of a command */
extern const cli_option cli_options[];
extern const size_t cli_option_count;

#endif
