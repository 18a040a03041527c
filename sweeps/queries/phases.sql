-- How collisions of the two sleds go, over friction and configuration (the angle q6 of sled B): 100 velocities of approach for each of 101 x 91 points.
SELECT mu, q6, count(*) AS collisions, count(*) FILTER (WHERE c['kind'] = 'ok') AS solved,
  count(*) FILTER (WHERE c['path'] = 'sliding') AS slides,
  count(*) FILTER (WHERE c['path'] IN ('sticking', 'sliding, then sticking')) AS sticks,
  count(*) FILTER (WHERE c['path'] IN ('renewal', 'sliding, then renewal')) AS renews,
  checksum(outcome_hash(c)) AS checksum
FROM (
  SELECT mu, q6, two_sleds_collide(named_struct('mu', mu, 'e', 0.8, 'law', 'stronge', 'q6', q6,
      'u1', 2.0 * sobol(i / 9191, 0, 1) - 1.0, 'u3', 2.0 * sobol(i / 9191, 1, 1) - 1.0,
      'u4', 2.0 * sobol(i / 9191, 2, 1) - 1.0, 'u6', 2.0 * sobol(i / 9191, 3, 1) - 1.0)) AS c
  FROM (SELECT i, linspace(i % 101, 0.0, 2.0, 101) AS mu, linspace(i / 101 % 91, 0.0, 6.283185307179586, 91) AS q6 FROM rows(919100)))
GROUP BY mu, q6
ORDER BY mu, q6
