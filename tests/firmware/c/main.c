/* Calls an exported library and tells every number of its answers by its bits: on a microcontroller and on a desktop. Nothing but the library and say() is needed. */
#include "two_sleds.h"

/* Writes a text to the standard output: board.c and desktop.c. */
void say(const char *text);

#ifdef SINGLE
typedef float number;
typedef uint32_t bits;
#else
typedef double number;
typedef uint64_t bits;
#endif

/* A number's bits as hexadecimal digits. */
static void tell(number value)
{
    union {
        number value;
        bits bits;
    } both;
    char text[] = " 0000000000000000";
    both.value = value;
    for (int place = 2 * (int)sizeof(bits); place > 0; place--, both.bits >>= 4)
        text[place] = "0123456789abcdef"[both.bits & 15];
    text[1 + 2 * sizeof(bits)] = 0;
    say(text);
}

static void line(const char *name, const number *numbers, int count)
{
    say(name);
    for (int place = 0; place < count; place++)
        tell(numbers[place]);
    say("\n");
}

/* How many calls answered otherwise than expected. */
int program(void)
{
    two_sleds_parameters parameters;
    two_sleds_coordinates q;
    two_sleds_speeds u, rates;
    two_sleds_collision hit, other;
    two_sleds sleds;
    number mass[4][4], energy;
    int wrong = 0;

    wrong += two_sleds_default_parameters(&parameters) != TWO_SLEDS_OK;
    wrong += two_sleds_default_coordinates(&q) != TWO_SLEDS_OK;
    wrong += two_sleds_default_speeds(&u) != TWO_SLEDS_OK;
    wrong += two_sleds_new(&parameters, &sleds) != TWO_SLEDS_OK;
    wrong += two_sleds_mass_matrix(&sleds, &q, mass) != TWO_SLEDS_OK;
    line("mass_matrix", &mass[0][0], 16);
    wrong += two_sleds_accelerations(&sleds, &q, &u, &rates) != TWO_SLEDS_OK;
    line("accelerations", (const number *)&rates, 4);
    wrong += two_sleds_kinetic_energy(&sleds, &q, &u, &energy) != TWO_SLEDS_OK;
    line("kinetic_energy", &energy, 1);
    for (int32_t law = TWO_SLEDS_NEWTON; law <= TWO_SLEDS_STRONGE; law++) {
        for (int step = 1; step <= 8; step++) {
            two_sleds_surface surface = {(number)step / 4, (number)0.5, law};
            wrong += two_sleds_collide_bc_ac(&sleds, &q, &u, &surface, &hit) != TWO_SLEDS_OK;
            line("impulse", hit.impulse, 3);
            line("separation", hit.separation, 3);
            line("speeds", (const number *)&hit.speeds, 4);
            line("energy_change", &hit.energy_change, 1);
            wrong += two_sleds_collide_bc_ac_with_budget(&sleds, &q, &u, &surface, 100, &other) != TWO_SLEDS_OK || other.energy_change != hit.energy_change;
            wrong += two_sleds_collide_bc_ac_with_budget(&sleds, &q, &u, &surface, 0, &other) != TWO_SLEDS_BUDGET_EXCEEDED;
        }
    }
    wrong += two_sleds_accelerations(&sleds, &q, 0, &rates) != TWO_SLEDS_NULL;
    say(wrong == 0 ? "all as expected\n" : "a call answered otherwise than expected\n");
    return wrong;
}
