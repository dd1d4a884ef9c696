"""Maps as sensors give them: noise, missing cells, quantisation, a pose that drifts or is late."""
