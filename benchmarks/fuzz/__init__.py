"""Random and damaged documents for the parser of requests and the reader of URDFs."""
