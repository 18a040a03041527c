/* Calls the library of the two sleds, and prints what it answers. */
#include "two_sleds.h"

#include <stdio.h>
#include <string.h>

static void print(const char *name, const double *numbers, int count)
{
    printf("%s", name);
    for (int place = 0; place < count; place++)
        printf(" %.17g", numbers[place]);
    printf("\n");
}

int main(void)
{
    two_sleds_parameters parameters;
    two_sleds_coordinates q;
    two_sleds_speeds u, rates;
    two_sleds sleds, copy;
    two_sleds_collision hit, other;
    two_sleds_closed_contact closed;
    two_sleds_surface surface = {0.5, 0.5, TWO_SLEDS_STRONGE};
    double mass[4][4], energy, position[3];

    if (two_sleds_default_parameters(&parameters) != TWO_SLEDS_OK || two_sleds_new(&parameters, &sleds) != TWO_SLEDS_OK)
        return 1;
    if (two_sleds_default_coordinates(&q) != TWO_SLEDS_OK || two_sleds_default_speeds(&u) != TWO_SLEDS_OK)
        return 2;
    if (two_sleds_mass_matrix(&sleds, &q, mass) != TWO_SLEDS_OK)
        return 3;
    print("mass_matrix", &mass[0][0], 16);
    copy = sleds;
    if (two_sleds_accelerations(&copy, &q, &u, &rates) != TWO_SLEDS_OK)
        return 4;
    print("accelerations", (const double *)&rates, 4);
    if (two_sleds_kinetic_energy(&sleds, &q, &u, &energy) != TWO_SLEDS_OK)
        return 5;
    print("kinetic_energy", &energy, 1);
    if (two_sleds_position_bc(&sleds, &q, position) != TWO_SLEDS_OK)
        return 6;
    print("position_bc", position, 3);
    if (two_sleds_collide_bc_ac(&sleds, &q, &u, &surface, &hit) != TWO_SLEDS_OK || hit.path != TWO_SLEDS_SLIDING)
        return 7;
    print("impulse", hit.impulse, 3);
    print("separation", hit.separation, 3);
    print("speeds", (const double *)&hit.speeds, 4);
    print("energy_change", &hit.energy_change, 1);
    printf("works %.17g %.17g\n", hit.impact.contact_work, hit.impact.normal_work);
    printf("compressions %d\n", (int)hit.impact.compressions);
    printf("sensitivity %d %d %d %d %d\n", (int)hit.impact.near_mu_c, (int)hit.impact.grazing, (int)hit.impact.unstable_direction, (int)hit.impact.no_slip, (int)hit.impact.jam);
    printf("energy_gained %.17g\n", hit.impact.energy_gained);
    if (two_sleds_contact_mode_bc_ac(&sleds, &q, &u, &surface, &closed) != TWO_SLEDS_OK)
        return 17;
    printf("selection %d\n", (int)closed.selection);

    /* Within a budget the answer is the same, or there is none. */
    memset(&other, 0, sizeof other);
    if (two_sleds_collide_bc_ac_with_budget(&sleds, &q, &u, &surface, 1, &other) != TWO_SLEDS_BUDGET_EXCEEDED || other.energy_change != 0)
        return 15;
    if (two_sleds_collide_bc_ac_with_budget(&sleds, &q, &u, &surface, 64, &other) != TWO_SLEDS_OK || memcmp(&other.impulse, &hit.impulse, sizeof hit.impulse) != 0)
        return 16;

    /* The answer may stand where an argument stands: the argument is read first. */
    if (two_sleds_accelerations(&sleds, &q, &u, &u) != TWO_SLEDS_OK)
        return 8;
    print("accelerations", (const double *)&u, 4);

    /* Mistakes are said and change nothing. */
    energy = 7;
    if (two_sleds_kinetic_energy(&sleds, &q, NULL, &energy) != TWO_SLEDS_NULL || two_sleds_kinetic_energy(&sleds, &q, &u, NULL) != TWO_SLEDS_NULL)
        return 9;
    u.u1 = 0.0 / 0.0;
    if (two_sleds_kinetic_energy(&sleds, &q, &u, &energy) != TWO_SLEDS_NOT_FINITE || energy != 7)
        return 10;
    surface.mu = -1;
    two_sleds_default_speeds(&u);
    if (two_sleds_collide_bc_ac(&sleds, &q, &u, &surface, &hit) != TWO_SLEDS_NEGATIVE_FRICTION)
        return 11;
    surface.law = 9;
    if (two_sleds_collide_bc_ac(&sleds, &q, &u, &surface, &hit) != TWO_SLEDS_UNKNOWN_LAW)
        return 12;
    surface = (two_sleds_surface){0.5, 0.5, TWO_SLEDS_POISSON};
    if (two_sleds_collide_bc_ac(&sleds, &q, &hit.speeds, &surface, &hit) != TWO_SLEDS_NOT_APPROACHING)
        return 13;
    parameters.m = -parameters.m;
    if (two_sleds_new(&parameters, &copy) != TWO_SLEDS_IMPOSSIBLE_MASS)
        return 14;
    return 0;
}
