/* The surroundings of the program on a desktop. */
#include <stdio.h>

int program(void);

void say(const char *text) { fputs(text, stdout); }

int main(void) { return program() != 0; }
